"""Short and long scripts over HTTP."""
