"""Short and long scripts: what they are, the library, their words and what is mended in them (SIMS 3.2)."""
