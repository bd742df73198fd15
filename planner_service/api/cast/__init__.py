"""The cast over HTTP."""
