"""One path of wide arcs in a real ArduPlane: along points and as turns round their centres.

Skipped unless ``SWATHPLAN_ARDUPLANE`` names the simulator's binary; see ``arduplane.py``. The rows that
``pytest --log-cli-level=INFO`` shows are those of docs/ardupilot.md.
"""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from mavlink.dialects.compare import differences
from mavlink.dialects.mission import Mission
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.options import Arcs
from mavlink.state.telemetry import VehicleState
from mavlink.wire.items import Command, MissionType
from tests.flows.arduplane import BINARY, HOME_ALTITUDE_M, aeroplane, arm, in_wind
from tests.flows.flying import STALLED_S, WIND
from tests.mavlink.plans import FRAME, START, Leg, flown, make_plan

pytestmark = [
    pytest.mark.ardupilot,
    pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator"),
]

log = logging.getLogger(__name__)

SPEEDUP = 40.0
TURNS_DEG = (-90.0, 135.0, -180.0, 225.0, -330.0)
STRAIGHT_M = 600.0
#: Behind each arc, the line is looked at as far as this.
BEHIND_M = 300.0
#: What the planner makes of turns of 100 m in a wind of 8 m/s at 20 m/s.
RADIUS_IN_WIND_M = 196.0


@dataclass(frozen=True, slots=True)
class ArcFigures:
    """How the arcs and the lines behind them were flown.

    Parameters
    ----------
    arc_p95_m
        Farthest from each arc, but for one place in twenty.
    back_m
        How far behind each arc the line was held within 5 m from then on.
    """

    items: int
    duration_s: float
    arc_p95_m: tuple[float, ...]
    back_m: tuple[float, ...]

    def tell(self, *head: str) -> None:
        """Log one row of a Markdown table."""
        cells = (
            *head,
            f"{self.items}",
            " · ".join(f"{one:.0f}" for one in self.arc_p95_m),
            " · ".join(f"{one:.0f}" for one in self.back_m),
            f"{self.duration_s:.0f} s",
        )
        log.info("| %s |", " | ".join(cells))


def legs(radius_m: float) -> tuple[Leg, ...]:
    """A straight, and behind each arc another."""
    pieces = [Leg(length_m=1000.0)]
    for turn_deg in TURNS_DEG:
        pieces += [Leg(turn_deg=turn_deg, radius_m=radius_m), Leg(length_m=STRAIGHT_M)]
    return tuple(pieces)


async def fly(
    folder: Path, radius_m: float, options: EncodeOptions, wind: tuple[float, float] | None
) -> ArcFigures:
    """Fly the path to its end, and no further."""
    mission = encode(make_plan(legs(radius_m)), options=options)
    last = max(item.seq for item in mission.mission if item.command == Command.NAV_WAYPOINT)
    async with aeroplane(folder, mission.home, SPEEDUP, in_wind(wind)) as client:
        stored = await client.upload_verified(
            mission.mission,
            MissionType.MISSION,
            lambda meant, held: differences(meant, held, mission.dialect),
        )
        assert (stored.status, stored.differences) == ("stored", ())
        await arm(client)
        recorder = client.start_recording()
        assert (await client.start_mission()).accepted
        for seq in range(1, last + 1):
            await client.wait_for(partial(_is_past, seq), STALLED_S)
        client.stop_recording(recorder)
        points = recorder.track().points
    at_height = next(n for n, point in enumerate(points) if point.relative_m > 295.0)
    places = FRAME.to_local([(point.lon_deg, point.lat_deg) for point in points[at_height:]])
    times_s = np.array([point.time_s for point in points[at_height:]])
    return judged(mission, radius_m, np.asarray(places), times_s)


def _is_past(seq: int, state: VehicleState) -> bool:
    return (state.mission_current or 0) > seq


def judged(
    mission: Mission, radius_m: float, places: NDArray[np.float64], times_s: NDArray[np.float64]
) -> ArcFigures:
    """Distances from the path, followed from its start on, as it crosses itself."""
    path = flown(legs(radius_m), START)
    sampled = path.sample(1.0, 1.0)
    samples, along_m = sampled[:, :2], sampled[:, 3]
    here_m = 0.0
    rows: list[tuple[float, float, float]] = []
    for place, time_s in zip(places, times_s, strict=True):
        near = np.flatnonzero((along_m >= here_m - 10.0) & (along_m <= here_m + (60.0 if rows else 700.0)))
        off_m = np.hypot(*(samples[near] - place).T)
        if not rows and off_m.min() > 15.0:
            continue
        here_m = along_m[near[off_m.argmin()]]
        rows.append((time_s, here_m, off_m.min()))
        if here_m > along_m[-1] - 25.0:
            break
    time_s, at_m, off_m = np.array(rows).T
    assert at_m[-1] > along_m[-1] - 50.0, "the path was not flown to its end"
    arc_p95_m, back_m, start_m = [], [], 0.0
    for segment in path.segments:
        end_m = start_m + segment.length_m
        if segment.kind != "straight":
            arc_p95_m.append(float(np.percentile(off_m[(at_m >= start_m) & (at_m <= end_m)], 95.0)))
            away = at_m[(at_m > end_m) & (at_m <= end_m + BEHIND_M) & (off_m > 5.0)]
            back_m.append(float(away[-1] - end_m) if len(away) else 0.0)
        start_m = end_m
    duration_s = float(time_s[-1] - time_s[0])
    return ArcFigures(len(mission.mission), duration_s, tuple(arc_p95_m), tuple(back_m))


@pytest.mark.parametrize(
    ("radius_m", "wind"), [(100.0, None), (RADIUS_IN_WIND_M, WIND)], ids=["still air", "wind"]
)
async def test_turns_are_flown_better_than_points(
    tmp_path: Path, radius_m: float, wind: tuple[float, float] | None
) -> None:
    """As turns: two thirds as far off on the arcs, back on the line sooner, no circle more, fewer items."""
    flights = {}
    choices: tuple[Arcs, ...] = ("points", "auto")
    for arcs in choices:
        folder = tmp_path / arcs
        folder.mkdir()
        options = EncodeOptions(arcs=arcs, home_altitude_m=HOME_ALTITUDE_M)
        flights[arcs] = await fly(folder, radius_m, options, wind)
        flights[arcs].tell(arcs, f"{radius_m:.0f} m", f"{wind[0]:g} m/s" if wind else "none")
    points, turns = flights["points"], flights["auto"]
    assert max(turns.arc_p95_m) < 2.0 / 3.0 * max(points.arc_p95_m)
    assert sum(turns.back_m) < sum(points.back_m)
    assert turns.items < points.items
    circle_s = math.tau * radius_m / 20.0
    assert turns.duration_s < points.duration_s + 0.5 * circle_s


async def test_closer_points_do_not_hold_arcs_better(tmp_path: Path) -> None:
    """It swings wide of any. Coarse ones cut the arc, which offsets some of that; the line is met later."""
    flights = {}
    for chord_error_m in (1.0, 2.0, 5.0, 10.0):
        folder = tmp_path / f"{chord_error_m:g}"
        folder.mkdir()
        options = EncodeOptions(arcs="points", chord_error_m=chord_error_m)
        flights[chord_error_m] = await fly(folder, 100.0, options, None)
        flights[chord_error_m].tell("points", f"{chord_error_m:g} m", "none")
    assert flights[1.0].items > flights[2.0].items > flights[5.0].items
    assert max(flights[2.0].arc_p95_m) < max(flights[1.0].arc_p95_m) + 2.0
    assert max(flights[10.0].arc_p95_m) < max(flights[2.0].arc_p95_m)
    assert sum(flights[10.0].back_m) > sum(flights[2.0].back_m)
