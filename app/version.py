"""The version of the installed distribution."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

try:
    VERSION = version("swathplan")
except PackageNotFoundError:  # run from a source tree that is not installed
    VERSION = "0.1.0"
