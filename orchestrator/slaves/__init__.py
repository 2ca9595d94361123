"""Running instances: every kind behind the same seven functions over doubles."""
