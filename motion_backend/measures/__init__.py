"""What is measured of a motion, one module a subject; `motion_backend.metrics` puts the figures of a trial together."""
