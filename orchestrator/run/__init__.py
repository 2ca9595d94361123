"""The life of a run: initial values, macro steps, texts, checkpoints, log."""
