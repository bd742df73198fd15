"""Furniture, graphs, rooms, homes and the ways through them. Imports nothing of ours."""
