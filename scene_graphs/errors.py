"""What a user can do wrong: one family of exceptions, whichever package raises them."""

from __future__ import annotations


class UserError(ValueError):
    """Something that was given cannot be used; the text names what, what is wrong with it and what would be right.

    The command line turns it into one line and exit code 2, the service into a problem with a pointer; anything else
    is a fault of ours.
    """
