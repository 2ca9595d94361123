"""A system of FMUs as plain frozen data."""
