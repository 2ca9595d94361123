"""Track geometry of one's own: measured, made of shapes and spectra, inspected, fitted."""
