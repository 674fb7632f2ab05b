"""Reporting progress and being stopped, as parameters."""

from __future__ import annotations

from typing import Protocol

from planner.errors import CancelledError


class Progress(Protocol):
    """Receives the stage at work and the fraction done of the whole plan."""

    def __call__(self, stage: str, fraction: float) -> None:
        """Take one report; ``fraction`` runs from 0 to 1 and never falls."""


class Stop(Protocol):
    """Says whether to stop; asked between steps. Any clock lives with the caller."""

    def __call__(self) -> bool:
        """True to stop."""


def silent(stage: str, fraction: float) -> None:
    """Drop the report."""


def never() -> bool:
    """Go on."""
    return False


def raise_if(stop: Stop) -> None:
    """Raise CancelledError once ``stop`` says so."""
    if stop():
        raise CancelledError("planning was cancelled")
