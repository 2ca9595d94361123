"""The car as a system of FMUs, and its linear model."""
