"""What studies share: their command, their outcome, a rig for one FMU, and the ring-down."""
