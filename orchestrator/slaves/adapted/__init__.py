"""FMI 2.0's functions over doubles in front of instances that have others."""
