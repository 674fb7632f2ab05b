"""Shortest paths of bounded curvature, and lines made flyable with them."""
