"""The procedural backend: a body moved by rules, styles and inverse kinematics."""
