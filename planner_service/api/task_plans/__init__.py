"""Task plans over HTTP."""
