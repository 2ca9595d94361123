"""What a Python FMU runs on."""
