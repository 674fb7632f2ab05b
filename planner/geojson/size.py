"""How large a scenario may be: what is larger is refused by name, before any of it is worked on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from planner.geojson.fields import Findings

MOST_FEATURES: Final = 5_000
#: Of all features together, of one region, and of any other feature.
MOST_CORNERS, MOST_OF_A_REGION, MOST_OF_ANOTHER = 200_000, 5_000, 20_000


def check_size(features: Sequence[Any], findings: Findings) -> bool:
    """Add a finding for each way in which a scenario is too large; whether it is not."""
    if len(features) > MOST_FEATURES:
        findings.error(
            "scenario",
            "too-many-features",
            f"has {len(features)} features, more than {MOST_FEATURES}",
            "Plan it in parts, and leave out what is far from what is flown.",
        )
        return False
    total, fits = 0, True
    for number, feature in enumerate(features):
        if not isinstance(feature, dict):
            continue
        corners = _corners(feature.get("geometry"))
        total += corners
        properties = feature.get("properties")
        role = properties.get("role") if isinstance(properties, dict) else None
        most = MOST_OF_A_REGION if role == "roi" else MOST_OF_ANOTHER
        if corners > most:
            fits = False
            named = feature.get("id")
            findings.error(
                str(named)[:80] if isinstance(named, (str, int)) else f"feature {number}",
                "too-many-corners",
                f"has {corners} corners, more than {most}",
                "Simplify it to what the map needs: a metre, or ten, between corners.",
            )
    if total > MOST_CORNERS:
        findings.error(
            "scenario",
            "too-many-corners",
            f"has {total} corners in all, more than {MOST_CORNERS}",
            "Simplify its shapes, or plan it in parts.",
        )
    return fits and total <= MOST_CORNERS


def _corners(geometry: Any) -> int:
    """Positions of a geometry, whatever it is."""
    if not isinstance(geometry, dict):
        return 0
    count = 0
    parts = [geometry.get("coordinates"), geometry.get("geometries")]
    while parts:
        part = parts.pop()
        if isinstance(part, dict):
            parts += [part.get("coordinates"), part.get("geometries")]
        elif isinstance(part, list):
            if part and not isinstance(part[0], (list, dict)):
                count += 1
            else:
                parts += part
    return count
