"""Walking: a route, footsteps on it, and a body carried over them."""
