"""Touching and what hands do."""
