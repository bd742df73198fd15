"""What furniture and rooms look like."""
