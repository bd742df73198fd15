"""Drawings of rooms and of matches."""
