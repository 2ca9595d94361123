"""What a run leaves: the record, the file, energies, metrics."""
