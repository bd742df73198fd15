"""Short and long scripts: keeping, finding, composing, checking and telling them."""
