"""What the irregularities of a track are made of, in the order in which they stand everywhere."""

CHANNELS = ("alignment", "profile", "cross_level", "gauge")
