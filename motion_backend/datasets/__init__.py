"""Captioned motion as learners want it: wordings, mirrors, sides of a split, and scales."""
