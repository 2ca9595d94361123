"""The carbody block: rigid and elastic modes, exact over a step."""
