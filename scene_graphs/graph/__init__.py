"""Furniture graphs: made, merged, compared exactly (SIMS 3.2)."""
