"""Extractions over HTTP."""
