"""Long scripts made of short ones (SIMS 3.2), or written at once (SIMS 10)."""
