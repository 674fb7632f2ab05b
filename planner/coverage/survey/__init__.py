"""Regions seen by cameras that look down: lanes whose photos overlap."""
