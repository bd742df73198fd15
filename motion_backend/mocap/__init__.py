"""Other people's motion: clips read, put onto our skeleton, labelled and kept as data sets (SIMS 4.1)."""
