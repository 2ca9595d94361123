"""Track geometry of one's own: measured, or made of shapes and spectra."""
