"""Pinned instances: our figures and a peer's in one run, as JSON lines: ``swathplan bench NAME``."""
