"""Composing rooms: an empty shell, groups of furniture that belong together, and where they go."""
