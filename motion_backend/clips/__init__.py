"""Other people's motion: files read into one kind of clip, and what becomes of it."""
