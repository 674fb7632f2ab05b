"""Strips of one search or of several flown together, moved for more of the worth found: annealed."""
