"""The track block: irregularities of alignment, profile, cross-level and gauge."""
