"""Figures that say how well a motion was done (SIMS 4.3): one module a figure, `story_metrics` for all of them."""
