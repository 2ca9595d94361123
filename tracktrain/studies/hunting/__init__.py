"""The hunting study."""
