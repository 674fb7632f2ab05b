"""The version of the service, which is the planner's."""

from __future__ import annotations

from planner.version import __version__

VERSION = __version__
