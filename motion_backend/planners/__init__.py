"""LINGO's motion planner (B.1.3): which motion follows which, and what can be done in a home."""
