"""What a story leaves behind: files and pictures."""
