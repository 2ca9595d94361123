"""Profiles of wheels and rails, and where a wheelset touches its track."""
