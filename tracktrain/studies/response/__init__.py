"""The response study."""
