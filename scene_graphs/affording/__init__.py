"""Finding the places of a piece of furniture that afford sitting, lying and touching."""
