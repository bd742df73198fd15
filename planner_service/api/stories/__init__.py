"""Stories and motions over HTTP."""
