"""Sitting down and standing up."""
