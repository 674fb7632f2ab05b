"""Between which heights a geographical zone forbids: EUROCAE ED-269's limits of a volume, ED-318's layer."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from app.imports.notes import Notes

_METRES = {"M": 1.0, "FT": 0.3048}
#: The limit, what it counts from, and the same as ED-318 calls them.
_ENDS = (
    ("floor_m", ("lowerLimit", "lower"), ("lowerVerticalReference", "lowerReference")),
    ("ceiling_m", ("upperLimit", "upper"), ("upperVerticalReference", "upperReference")),
)
_OF_GROUND = (
    "heights of zones that count from the ground, or from nothing that is known, are left out: such a zone"
    " is forbidden to that side at every height"
)


def metres(volume: Mapping[str, Any]) -> float | None:
    """What one of its units is in metres; None where that is not known."""
    unit = volume.get("uomDimensions", volume.get("uom", "M"))
    return _METRES.get(unit.strip().upper()) if isinstance(unit, str) else None


def finite(value: Any) -> float | None:
    """A number of JSON that is one; None for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def band_of(volume: Mapping[str, Any], notes: Notes) -> dict[str, str]:
    """Floor and ceiling over the sea, as texts; what is not known to count from there is no limit."""
    unit_m = metres(volume)
    found: dict[str, float] = {}
    for key, limits, references in _ENDS:
        value = next((volume[name] for name in limits if name in volume), None)
        reference = next((volume[name] for name in references if name in volume), None)
        if value is None or (key == "floor_m" and value == 0 and reference in ("AGL", "SFC")):
            continue
        number = finite(value)
        over_sea = isinstance(reference, str) and reference.strip().upper() == "AMSL"
        if number is None or unit_m is None or not over_sea:
            _tell(notes)
        else:
            found[key] = number * unit_m
    if found.get("floor_m", -math.inf) >= found.get("ceiling_m", math.inf):
        _tell(notes)
        return {}
    return {key: json.dumps(value) for key, value in found.items()}


def _tell(notes: Notes) -> None:
    if _OF_GROUND not in notes:
        notes.append(_OF_GROUND)
