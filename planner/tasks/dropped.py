"""What is said of regions that a flight leaves out."""

from __future__ import annotations

from planner.errors import Finding, InfeasibleError
from planner.plan import LeftOut
from planner.tasks.limits import Dropped
from planner.tasks.task import NOT_SEEN


def unseen(error: InfeasibleError) -> Finding:
    """Of a region that no pass sees, by what says so."""
    rule = f"{NOT_SEEN}{error.constraint}"
    return Finding(error.feature, rule, error.message, error.relaxation, "warning")


def over(dropped: Dropped) -> Finding:
    """Of a region that a limit leaves out."""
    excess = dropped.excess
    return Finding(
        dropped.name,
        f"{NOT_SEEN}{excess.constraint}",
        f"is left out: with it the flight takes {excess.used:.0f} {excess.unit}, there are "
        f"{excess.limit:.0f} {excess.unit}",
        "Raise the limit, its priority, or plan it as a flight of its own.",
        "warning",
    )


def left_out(dropped: tuple[Finding, ...], left: tuple[Dropped, ...]) -> tuple[LeftOut, ...]:
    """What is not seen at all, and why, for the metrics."""
    margins = {each.name: each.excess.margin for each in left}
    return tuple(
        LeftOut(name, finding.rule.removeprefix(NOT_SEEN), margins.get(name))
        for finding in dropped
        if finding.rule.startswith(NOT_SEEN)
        for name in finding.feature.split("+")
    )
