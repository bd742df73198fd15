"""Files a motion can be written to and read from."""
