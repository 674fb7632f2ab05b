"""What a scenario says of the plan that its own is to take the place of in flight: the member ``replan``."""

from __future__ import annotations

from typing import Any

from planner.frames import LocalFrame
from planner.geojson.fields import Fields, Findings
from planner.wishes import GoingOn, Unflown

#: No plan begins later after the call for it, s.
MOST_S = 600.0
#: Nothing is flown higher.
MOST_HEIGHT_M = 30_000.0
#: Sides that a sensor looks to.
LOOKS = ("left", "right", "down")


def read_going_on(raw: Any, frame: LocalFrame, findings: Findings) -> GoingOn | None:
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
    unflown = _unflown(raw.get("unflown"), frame, findings)
    until = _until(raw.get("until"), frame, findings)
    fields.refuse_unknown(also_known=("order", "unflown", "until"))
    if begins_in_s is None or share is None or order is None or unflown is None or until is None:
        return None
    return GoingOn(begins_in_s, order, share, unflown, until)


def _until(
    raw: Any, frame: LocalFrame, findings: Findings
) -> dict[str, tuple[tuple[float, float, float], ...]] | None:
    """Lines flown until the plan begins, by the name of an aircraft."""
    if raw is None:
        return {}
    lines = raw.values() if isinstance(raw, dict) else [None]
    if all(_is_line(line) for line in lines):
        found = {}
        for name, line in raw.items():
            places = frame.to_local([place[:2] for place in line]).tolist()
            rows = zip(places, line, strict=True)
            found[str(name)] = tuple((east, north, float(place[2])) for (east, north), place in rows)
        return found
    findings.error(
        "replan", "bad-value", "until is not an object of lines",
        'Write until: {"the aircraft": [[10.0, 47.0, 80.0], [10.1, 47.0, 80.0]]}, longitude, latitude and '
        "metres over home, or leave it out.",
    )  # fmt: skip
    return None


def _is_line(raw: Any) -> bool:
    return (
        isinstance(raw, list)
        and len(raw) >= 2
        and all(isinstance(p, list) and len(p) == 3 and _on_earth(*p[:2]) and _is_height(p[2]) for p in raw)
    )


def _is_height(raw: Any) -> bool:
    plain = isinstance(raw, int | float) and not isinstance(raw, bool)
    return plain and abs(raw) <= MOST_HEIGHT_M


def _unflown(raw: Any, frame: LocalFrame, findings: Findings) -> dict[str, tuple[Unflown, ...]] | None:
    """Passes of a search by the name of an aircraft."""
    if raw is None:
        return {}
    lists = raw.values() if isinstance(raw, dict) else [None]
    if all(isinstance(each, list) and all(_is_pass(one) for one in each) for each in lists):
        return {str(name): tuple(_pass(one, frame) for one in each) for name, each in raw.items()}
    findings.error(
        "replan", "bad-value", "unflown is not an object of lists of passes",
        'Write unflown: {"the aircraft": [{"line": [[10.0, 47.0], [10.1, 47.0]], "look": "down"}]}, or leave '
        "it out.",
    )  # fmt: skip
    return None


def _is_pass(raw: Any) -> bool:
    line = raw.get("line") if isinstance(raw, dict) else None
    return (
        isinstance(line, list)
        and len(line) == 2
        and all(isinstance(place, list) and len(place) == 2 and _on_earth(*place) for place in line)
        and line[0] != line[1]
        and raw.get("look") in LOOKS
    )


def _on_earth(lon_deg: Any, lat_deg: Any) -> bool:
    """Whether both are numbers of degrees."""
    plain = all(isinstance(v, int | float) and not isinstance(v, bool) for v in (lon_deg, lat_deg))
    return plain and abs(lon_deg) <= 180.0 and abs(lat_deg) <= 90.0


def _pass(raw: Any, frame: LocalFrame) -> Unflown:
    (start_e, start_n), (end_e, end_n) = frame.to_local(raw["line"]).tolist()
    return Unflown((start_e, start_n), (end_e, end_n), raw["look"])


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
