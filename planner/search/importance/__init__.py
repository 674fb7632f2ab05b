"""Walks over a grid of importance: as published, and the most that a battery collects."""
