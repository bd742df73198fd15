"""Ways through a home."""
