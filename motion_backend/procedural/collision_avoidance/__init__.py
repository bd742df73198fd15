"""Hands, elbows and arms kept out of furniture and off the body."""
