"""The one reader of English: clauses, beats, feelings and who a theme is about."""
