"""A long script made real: rooms, objects, and actions for its keyframes (SIMS 3.2, 3.4)."""
