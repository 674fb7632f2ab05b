"""Sensors: what they see on the ground from where."""
