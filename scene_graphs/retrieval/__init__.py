"""The rooms and homes that fit a graph (SIMS 3.2)."""
