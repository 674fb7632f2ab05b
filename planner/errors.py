"""Everything the planner refuses, in one tree.

::

    PlannerError
    ├── ScenarioError      the input is wrong; carries every finding, each naming feature, rule and fix
    ├── InfeasibleError    the input is sound, no plan can satisfy it: constraint, feature, place, relaxation
    ├── OutOfBudgetError   the time or iteration budget ended before any answer was found
    └── CancelledError     the caller asked to stop
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing wrong, or worth knowing, about a scenario.

    Parameters
    ----------
    feature
        The feature's id or name; ``"scenario"`` for a foreign member of the collection.
    rule
        Machine-readable name of the rule, e.g. ``"ring-self-intersects"``.
    message
        What is wrong, with the offending value.
    fix
        What to change.
    severity
        ``"error"`` findings refuse the scenario, ``"warning"`` findings do not.
    """

    feature: str
    rule: str
    message: str
    fix: str
    severity: Literal["error", "warning"] = "error"

    def __str__(self) -> str:
        return f"{self.feature}: {self.message} ({self.rule}). {self.fix}"


class PlannerError(Exception):
    """Base of all errors raised by the planner."""


class ScenarioError(PlannerError):
    """The scenario is refused; ``findings`` holds every reason found, not only the first."""

    def __init__(self, findings: tuple[Finding, ...]) -> None:
        self.findings = findings
        super().__init__("; ".join(str(finding) for finding in findings))


class InfeasibleError(PlannerError):
    """No plan can satisfy the scenario.

    Parameters
    ----------
    constraint
        Name of the binding constraint, e.g. ``"area"``, ``"swath"``, ``"hard-zone"``, ``"turn-radius"``.
    feature
        The feature concerned.
    message
        Why, in words.
    relaxation
        The nearest change that would help.
    where_enu_m
        The place, east and north in the scenario's frame, when there is one.
    """

    def __init__(
        self,
        constraint: str,
        feature: str,
        message: str,
        relaxation: str,
        where_enu_m: tuple[float, float] | None = None,
    ) -> None:
        self.constraint = constraint
        self.feature = feature
        self.message = message
        self.relaxation = relaxation
        self.where_enu_m = where_enu_m
        super().__init__(f"{feature}: {message} ({constraint}). {relaxation}")

    def __reduce__(self) -> tuple[type[InfeasibleError], tuple[object, ...]]:
        """Pickle by arguments: errors cross from worker processes."""
        return type(self), (self.constraint, self.feature, self.message, self.relaxation, self.where_enu_m)


def nothing_seen(why: Sequence[Finding | InfeasibleError]) -> InfeasibleError:
    """What is said where no region is required and none can be seen: of each why, and what would help."""
    told = [(each.feature, each.message, _fix(each)) for each in dict.fromkeys(why)]
    message = "; ".join(dict.fromkeys(f"{feature}: {message}" for feature, message, _ in told))
    fix = " ".join(dict.fromkeys(f"{fix[:1].upper()}{fix[1:].rstrip('.')}." for _, _, fix in told if fix))
    return InfeasibleError(
        "swath",
        "scenario",
        f"no region can be seen: {message or 'there is none'}",
        fix or "Add a region that can be seen.",
    )


def _fix(each: Finding | InfeasibleError) -> str:
    return each.fix if isinstance(each, Finding) else each.relaxation


class OutOfBudgetError(PlannerError):
    """The budget ended before an answer was found."""


class CancelledError(PlannerError):
    """The caller asked to stop."""
