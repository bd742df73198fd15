"""Seeded procedural rooms."""
