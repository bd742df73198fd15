"""Learned motion: LINGO's auto-regressive diffusion model, its sampler, its training and the backend over it."""
