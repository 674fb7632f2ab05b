"""Scenarios of every kind, drawn at random, their plans judged by geometry of the tests' own."""
