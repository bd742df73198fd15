"""What a body can do with furniture, and where (SIMS 4.1)."""
