"""The short scripts and rooms there are: ours and the users'."""
