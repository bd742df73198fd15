"""Touching: reaching for a place, and what hands do there."""
