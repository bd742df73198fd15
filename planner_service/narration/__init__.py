"""A long script told as a story."""
