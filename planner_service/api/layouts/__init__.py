"""Rooms and furniture graphs over HTTP."""
