"""Short scripts out of films and texts (SIMS 3.2)."""
