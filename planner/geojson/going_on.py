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
    share = fields.number("unless_better", GoingOn().unless_better, minimum=0.0, maximum=1.0)
    order = _order(raw.get("order"), findings)
    fields.refuse_unknown(also_known=("order",))
    if begins_in_s is None or share is None or order is None:
        return None
    return GoingOn(begins_in_s, order, share)


def _order(raw: Any, findings: Findings) -> dict[str, tuple[str, ...]] | None:
    """Names of regions by the name of an aircraft; those that are no more are no matter."""
    if raw is None:
        return {}
    lists = raw.values() if isinstance(raw, dict) else [None]
    if all(isinstance(each, list) and all(isinstance(name, str) for name in each) for each in lists):
        return {str(name): tuple(each) for name, each in raw.items()}
    findings.error(
        "replan", "bad-value", "order is not an object of lists of names",
        'Write order: {"the aircraft": ["a region", "the next"]}, or leave it out.',
    )  # fmt: skip
    return None
