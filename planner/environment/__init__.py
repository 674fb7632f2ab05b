"""Threats, zones and the risk along a line."""
