"""What a scenario says of the plan that its own is to take the place of in flight: the member ``replan``."""

from __future__ import annotations

from typing import Any

from planner.geojson.fields import Fields, Findings
from planner.wishes import GoingOn

#: No plan begins later after the call for it, s.
MOST_S = 600.0


def read_going_on(raw: Any, findings: Findings) -> GoingOn | None:
    """Member ``replan``; None where it is absent."""
    if raw is None:
        return None
    if not isinstance(raw, dict):
        findings.error(
            "scenario",
            "bad-value",
            "replan is not an object",
            'Write replan: {"begins_in_s": 6}, or leave it out.',
        )
        return None
    fields = Fields("replan", raw, findings)
    begins_in_s = fields.number("begins_in_s", 0.0, minimum=0.0, maximum=MOST_S)
    fields.refuse_unknown()
    return None if begins_in_s is None else GoingOn(begins_in_s)
