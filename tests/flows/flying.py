"""What flights in every simulator share: a shared case to fly, the flight to its end, and its figures.

``pytest --log-cli-level=INFO`` shows the figures of each flight as a row of a Markdown table.
"""

from __future__ import annotations

import asyncio
import json
import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from shapely.geometry import LineString, Polygon

from app.services.flights.seen import seen_by
from app.services.records import TrackSample
from app.services.vehicles.recorder import Thinner
from mavlink.dialects.compare import differences
from mavlink.dialects.mission import Mission
from mavlink.state.telemetry import VehicleState
from mavlink.state.track import Track
from mavlink.station.client import VehicleClient
from mavlink.station.verify import VerifiedUpload
from mavlink.wire.items import MissionType
from planner.as_flown.coverage import FlownCoverage
from planner.plan import Plan
from planner.scenario import Scenario

log = logging.getLogger(__name__)

EXAMPLES = Path(__file__).parents[2] / "examples"
CASES = (1, 2, 3, 4)
#: Without a new item of the mission for this long, in real time, the flight is given up.
STALLED_S = 180.0
#: A vehicle breaks off a transfer after some seconds without an item: in its time, which runs fast here.
UPLOADS = 3
#: The wind of the flights in wind: m/s, and where it comes from.
WIND = (8.0, 270.0)


def case_document(
    case: int,
    vehicle: dict[str, Any],
    sensor: dict[str, Any] | None = None,
    wind: tuple[float, float] | None = None,
) -> dict[str, Any]:
    """A shared case, with properties of its vehicle and sensor changed, and a wind of speed and origin."""
    document: dict[str, Any] = json.loads((EXAMPLES / f"sar-case-{case}.geojson").read_text())
    document["vehicles"][0].update(vehicle)
    document["sensors"][0].update(sensor or {})
    if wind is not None:
        document["wind"] = {"speed_m_s": wind[0], "from_deg": wind[1]}
    return document


async def store(client: VehicleClient, mission: Mission) -> dict[MissionType, VerifiedUpload]:
    """Upload mission and fence, and read both back; they must be held as meant, without a word against."""
    results = {}
    for kind in (MissionType.MISSION, MissionType.FENCE):
        for _ in range(UPLOADS):
            result = await client.upload_verified(
                mission.items_of(kind), kind, lambda meant, held: differences(meant, held, mission.dialect)
            )
            if result.outcome.kind == "accepted":
                break
        assert (result.status, result.differences, result.objections) == ("stored", (), ()), result
        results[kind] = result
    return results


@dataclass(frozen=True, slots=True)
class Flight:
    """A mission flown to its end."""

    track: Track
    texts: tuple[str, ...]
    final: VehicleState

    def samples(self) -> tuple[TrackSample, ...]:
        """Every place of the track, as the service keeps them."""
        return tuple(Thinner(0.0).more(self.track))


async def until_disarmed(client: VehicleClient) -> tuple[str, ...]:
    """Wait for the end of a flight; what the vehicle said meanwhile."""
    texts: list[str] = []
    last_seq, quiet_s = -1, 0.0
    while client.state.armed:
        await asyncio.sleep(0.05)
        state = client.state
        assert state.connected, "the simulator fell silent"
        texts += [text.text for text in state.texts if text.text not in texts]
        quiet_s = 0.0 if state.mission_current != last_seq else quiet_s + 0.05
        last_seq = state.mission_current if state.mission_current is not None else -1
        assert quiet_s < STALLED_S, f"stuck at item {last_seq}, mode {state.mode}: {texts[-5:]}"
    return tuple(texts)


def inside_fence(scenario: Scenario, plan: Plan, samples: Sequence[TrackSample]) -> bool:
    """Whether the whole track lies in the areas flown in."""
    places = scenario.frame.to_local([(sample.lon_deg, sample.lat_deg) for sample in samples])
    return all(
        Polygon(scenario.frame.to_local(zone.ring)).contains(LineString(places))
        for zone in plan.fence.inclusion
    )


def from_end_m(scenario: Scenario, plan: Plan, final: VehicleState) -> float:
    """How far from the plan's end the vehicle came to rest."""
    assert final.lon_deg is not None
    assert final.lat_deg is not None
    here, there = scenario.frame.to_local([(final.lon_deg, final.lat_deg), plan.end])
    return math.dist(here, there)


@dataclass(frozen=True, slots=True)
class Figures:
    """What a flight is judged by.

    Parameters
    ----------
    items
        Of the mission and of the fence.
    cross_track_p95_m
        By pass, in the order flown.
    level
        Regions seen had the beam been held level.
    """

    scenario: Scenario
    plan: Plan
    items: tuple[int, int]
    ground: FlownCoverage
    level: FlownCoverage
    heights_m: tuple[float, float]
    duration_s: float

    @property
    def cross_track_p95_m(self) -> tuple[float, ...]:
        """By pass, in the plan's order."""
        return tuple(one.cross_track_p95_m for one in self.ground.passes)

    @property
    def least_seen(self) -> float:
        """Of the region seen least."""
        return min(self.ground.fraction.values())

    def tell(self, *head: str) -> None:
        """Log one row of a Markdown table."""
        worst_m = max(one.cross_track_max_m for one in self.ground.passes)
        cells = (
            *head,
            f"{self.plan.metrics.length_m / 1000:.1f} km",
            f"{self.items[0]}, {self.items[1]}",
            f"{min(self.cross_track_p95_m):.1f}–{max(self.cross_track_p95_m):.1f} m",
            f"{worst_m:.1f} m",
            f"{self.least_seen:.4f}",
            f"{self.heights_m[0]:.1f}–{self.heights_m[1]:.1f} m",
            f"{self.duration_s / 60:.0f} min",
        )
        log.info("| %s |", " | ".join(cells))


def figures(scenario: Scenario, plan: Plan, mission: Mission, samples: tuple[TrackSample, ...]) -> Figures:
    """Judge a track against its plan; every collect must have been flown."""
    ground = seen_by(scenario, plan, samples)
    level = seen_by(scenario, plan, tuple(replace(sample, roll_deg=0.0) for sample in samples))
    assert [one.seq for one in ground.passes] == [c.seq for c in plan.collects_of(mission.vehicle)]
    heights_m = [sample.altitude_home_m or 0.0 for sample in samples if sample.sensor_on]
    return Figures(
        scenario,
        plan,
        (len(mission.mission), len(mission.fence)),
        ground,
        level,
        (min(heights_m), max(heights_m)),
        samples[-1].time_s - samples[0].time_s,
    )
