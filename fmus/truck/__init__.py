"""The truck block: a six-mode nonlinear analog of a three-piece freight truck."""
