"""Meshes, boxes, rasters and grids of a home."""
