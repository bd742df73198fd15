"""Task plans: an instruction broken into steps, and each step acted by the body as far as it can (LINGO appendix C)."""
