"""Whole flights in real autopilots against what was planned: a small case to fly, and the comparison.

``pytest --log-cli-level=INFO`` shows a row of a Markdown table for each flight.
"""

from __future__ import annotations

import json
import logging
from dataclasses import dataclass
from typing import Any

from app.services.flights.phases import FlownPhase, flown_phases
from planner.plan import FlownPath, PhaseKind
from tests.flows.flying import EXAMPLES, Flight

log = logging.getLogger(__name__)

#: A shared case drawn so much smaller fits a multirotor.
SMALL = 0.12
#: In cruise; what energy is told in follows from it.
POWER_W = 200.0


def small_case(**vehicle: Any) -> dict[str, Any]:
    """Case 1 about its start, an eighth as wide, 80 m up, for a multirotor at 10 m/s."""
    document: dict[str, Any] = json.loads((EXAMPLES / "sar-case-1.geojson").read_text())
    start = next(f for f in document["features"] if f["properties"]["role"] == "start")
    origin = start["geometry"]["coordinates"][:2]

    def drawn(places: Any) -> Any:
        if isinstance(places[0], list):
            return [drawn(place) for place in places]
        return [o + SMALL * (c - o) for o, c in zip(origin, places, strict=False)]

    for feature in document["features"]:
        feature["geometry"]["coordinates"] = drawn(feature["geometry"]["coordinates"])
        for name in ("radius_m", "intensity_m"):
            if name in feature["properties"]:
                feature["properties"][name] *= SMALL
    document["altitude_m"] = 80.0
    own = {"type": "multirotor", "airspeed_m_s": 10.0, "finish": "land", "settle_m": 20}
    document["vehicles"] = [{"name": "uav-1", "cruise_power_w": POWER_W} | own | vehicle]
    return document


@dataclass(frozen=True, slots=True)
class Compared:
    """Durations of a flight's phases as planned and as flown; energy is theirs at the planned power."""

    phases: tuple[FlownPhase, ...]
    energy_wh: float

    @property
    def planned_s(self) -> float:
        """Of all phases."""
        return sum(phase.planned_s for phase in self.phases)

    @property
    def flown_s(self) -> float:
        """Of all phases, each of which was recorded."""
        flown = [phase.flown_s for phase in self.phases]
        assert None not in flown, self.phases
        return sum(seconds for seconds in flown if seconds is not None)

    @property
    def share(self) -> float:
        """Flown over planned, all phases together, of duration and of energy."""
        return self.flown_s / self.planned_s

    def share_of(self, *kinds: PhaseKind) -> float:
        """Of some phases together."""
        chosen = [phase for phase in self.phases if phase.kind in kinds]
        return sum(phase.flown_s or 0.0 for phase in chosen) / sum(phase.planned_s for phase in chosen)


def compared(flight: Flight, path: FlownPath, name: str, wind: str) -> Compared:
    """A flight against its path; tells one row of a table."""
    assert path.energy_wh is not None
    found = Compared(flown_phases(path, flight.samples()), path.energy_wh)
    cells = [
        f"{phase.kind} {phase.planned_s:.0f} → {phase.flown_s:.0f} s"
        for phase in found.phases
        if phase.flown_s is not None
    ]
    log.info(
        "| %s | %s | %s | %.0f → %.0f s | %.1f → %.1f Wh | %.3f |",
        name,
        wind,
        " · ".join(cells),
        found.planned_s,
        found.flown_s,
        found.energy_wh,
        found.energy_wh * found.share,
        found.share,
    )
    return found
