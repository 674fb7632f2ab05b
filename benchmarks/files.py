"""What benchmarks say of files that they cannot take."""

from __future__ import annotations


class FileError(ValueError):
    """A file that is no problem of the kind a benchmark solves."""
