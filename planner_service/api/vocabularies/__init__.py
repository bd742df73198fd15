"""The words of scripts over HTTP."""
