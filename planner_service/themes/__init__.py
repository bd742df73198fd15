"""Reading a theme: sentences, events, feelings and who it is about."""
