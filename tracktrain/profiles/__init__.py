"""Profiles of wheels and rails from files, and what a pair of them does."""
