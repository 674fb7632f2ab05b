"""Segments round the targets of a plan: which there are, which it takes, and why not others."""
