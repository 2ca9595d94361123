"""From a system and its descriptions to what masters need: checked, ordered, numbered."""
