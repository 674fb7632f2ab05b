"""The version, in one place: every plan carries it."""

__version__ = "0.1.0"
