"""The order of many regions, by local search."""
