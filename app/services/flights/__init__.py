"""Flights: what they saw and missed, in which files they are given, what makes up for them."""
