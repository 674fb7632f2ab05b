"""Scenarios before they are planned: judged, and made of other programs' files."""
