"""Elevation rasters: read, packed, kept."""
