"""One space for words and motion: the language-aware embedding of SIMS 3.3."""
