"""The wheelrail block: one wheelset on its rails."""
