"""Scripts, stories, language models and the command line. May import every other package."""
