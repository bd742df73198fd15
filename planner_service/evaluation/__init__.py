"""The figures of `sims evaluate`: bodies, scripts, walks and planning beside their limits."""
