"""What an FMU file says of itself: archive, description, arrays, units, port maps."""
