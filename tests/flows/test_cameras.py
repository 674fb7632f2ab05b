"""Camera surveys flown by real autopilots: the photos that their plan has, where it has them.

Skipped unless ``SWATHPLAN_ARDUPLANE``, ``SWATHPLAN_ARDUCOPTER``, or ``SWATHPLAN_PX4`` and
``SWATHPLAN_PX4_ROMFS`` name the simulators. ``pytest --log-cli-level=INFO`` shows a row for each flight.
"""

from __future__ import annotations

import asyncio
import logging
import math
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.trigger import payload_of
from mavlink.state.photos import PhotoTaken
from mavlink.station.client import VehicleClient
from mavlink.wire.items import Command, MissionType
from planner.airspace.terrain import Terrain
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from tests.flows import arduplane, px4
from tests.flows.flying import Flight, store
from tests.flows.test_ardupilot_phases import COPTER, calibrated, hovering
from tests.patience import PATIENCE_S
from tests.planner.terrains import raster

log = logging.getLogger(__name__)

FRAME = LocalFrame(8.0, 47.0)
HEIGHT_M = 150.0
#: ArduPilot's camera on a servo; PX4's on MAVLink, released by distance.
ARDUPILOT = {"CAM1_TYPE": 1, "SERVO9_FUNCTION": 10}
PX4 = {**px4.PARAMETERS, "TRIG_MODE": 4, "TRIG_INTERFACE": 3}
#: Of the photos planned, and of the time from the first to the last.
WITHIN = 0.03
COUNT_WITHIN = 0.01
#: Up and down slopes ArduPlane holds its airspeed less well.
HILLY_WITHIN = 0.06
#: How well heights are held while they change.
HELD_M = 8.0


def survey(sensor: dict[str, Any] | None = None, ground: Terrain | None = None, **vehicle: Any) -> Plan:
    """Lanes over a field of 600 by 350 m, 150 m over the ground, which is followed where it is given."""
    over: dict[str, Any] = {"altitude_reference": "home"}
    if ground is not None:
        over = {"altitude_reference": "terrain", "terrain": ground.name, "terrain_following": True}
    field = [[200.0, 150.0], [800.0, 150.0], [800.0, 500.0], [200.0, 500.0], [200.0, 150.0]]
    ring = [list(FRAME.to_wgs84((east, north))) for east, north in field]
    eye = {"name": "eye", "type": "camera", "focal_length_m": 0.035, "pixel_pitch_m": 4.5e-6}
    return make_plan(
        read_scenario(
            {
                "type": "FeatureCollection",
                "features": [
                    {
                        "type": "Feature",
                        "id": "field",
                        "geometry": {"type": "Polygon", "coordinates": [ring]},
                        "properties": {"role": "roi"},
                    },
                    {
                        "type": "Feature",
                        "id": "start",
                        "geometry": {"type": "Point", "coordinates": list(FRAME.to_wgs84((0.0, 0.0)))},
                        "properties": {"role": "start"},
                    },
                ],
                "vehicles": [{"name": "uav-1", "finish": "land", **vehicle}],
                "sensors": [{**eye, "image_px": [7952, 5304], **(sensor or {})}],
                "altitude_m": HEIGHT_M,
                **over,
            },
            {} if ground is None else {ground.name: ground},
        )
    )


def judged(name: str, plan: Plan, flight: Flight, within: float = WITHIN) -> tuple[PhotoTaken, ...]:
    """The photos of a flight against those of its plan; tells one row of a table."""
    taken = flight.track.photos
    planned = sum(len(photos.places) for photos in plan.photos)
    places = [FRAME.to_local((photo.lon_deg, photo.lat_deg)) for photo in taken]
    ends_m, counts, gaps = [], [], []
    for photos in plan.photos:
        first, last = (FRAME.to_local(photos.places[k][:2]) for k in (0, -1))
        length_m = math.dist(first, last)
        ahead = [(b - a) / length_m for a, b in zip(first, last, strict=True)]
        along_m = []
        for east, north in places:
            off = (east - first[0], north - first[1])
            at_m, aside_m = off[0] * ahead[0] + off[1] * ahead[1], off[1] * ahead[0] - off[0] * ahead[1]
            if abs(aside_m) < 15.0 and -60.0 < at_m < length_m + 60.0:
                along_m.append(at_m)
        along_m.sort()
        assert along_m, f"collect {photos.seq} has no photos"
        counts.append(len(along_m) - len(photos.places))
        ends_m += [along_m[0], along_m[-1] - length_m]
        gaps.append(max(b - a for a, b in pairwise(along_m)) / photos.interval_m)
    collects = plan.collects_of("uav-1")
    planned_s = collects[-1].end_s - collects[0].start_s
    flown_s = taken[-1].time_s - taken[0].time_s
    log.info(
        "| %s | %d of %d | %s | %.1f–%.1f m | %.1f–%.1f m | %.2f | %.0f → %.0f s | %.3f |",
        name,
        len(taken),
        planned,
        " ".join(f"{more:+d}" for more in counts),
        *(bound(ends_m[k::2]) for k in (0, 1) for bound in (min, max)),
        max(gaps),
        planned_s,
        flown_s,
        flown_s / planned_s,
    )
    assert abs(len(taken) - planned) <= COUNT_WITHIN * planned
    assert flown_s == pytest.approx(planned_s, rel=within)
    assert max(gaps) < 1.5, "none is missing on any pass"
    return taken


@asynccontextmanager
async def ready(client: VehicleClient, plan: Plan, home_m: float = 0.0) -> AsyncIterator[None]:
    """The plan's mission on board, read back equal."""
    await client.wait_for(lambda state: state.home_lat_deg is not None, PATIENCE_S)
    await store(client, encode(plan, options=EncodeOptions(home_altitude_m=home_m)))
    yield


@pytest.mark.ardupilot
@pytest.mark.skipif(not arduplane.BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator")
@pytest.mark.parametrize("trigger", ["distance", "time"])
async def test_arduplane_takes_the_photos_planned(tmp_path: Path, trigger: str) -> None:
    """By distance and by time: as many as planned within 1 %, in the time planned within 3 %."""
    plan = survey(
        {"trigger": trigger}, type="fixed_wing", autopilot="ardupilot", airspeed_m_s=20.0,
        min_turn_radius_m=100.0, settle_m=150.0,
    )  # fmt: skip
    heading_deg = plan.paths[0].take_off_heading_deg
    assert heading_deg is not None
    own = {**arduplane.PARAMETERS, **ARDUPILOT, **calibrated(arduplane.HOME_ALTITUDE_M + HEIGHT_M)}
    async with (
        arduplane.aeroplane(tmp_path, plan.home, 20.0, own, heading_deg=heading_deg) as client,
        ready(client, plan, arduplane.HOME_ALTITUDE_M),
    ):
        flight = await arduplane.fly(client)
    taken = judged(f"ArduPlane, by {trigger}", plan, flight)
    assert {photo.source for photo in taken} == {"autopilot"}
    heights_m = [photo.altitude_amsl_m - arduplane.HOME_ALTITUDE_M for photo in taken]
    assert HEIGHT_M - 5.0 < min(heights_m) <= max(heights_m) < HEIGHT_M + 5.0


@pytest.mark.ardupilot
@pytest.mark.skipif(not arduplane.BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator")
async def test_arduplane_follows_the_ground(tmp_path: Path) -> None:
    """Over hills, each photo as high over its own ground as planned, within what heights are held."""
    low_m, high_m = arduplane.HOME_ALTITUDE_M, arduplane.HOME_ALTITUDE_M + 40.0
    hills = raster(
        lambda east, north: np.where(
            east + north < 0.0,
            low_m,
            (low_m + high_m - (high_m - low_m) * np.cos((east + north) / 230.0)) / 2.0,
        ),
        FRAME,
        half_deg=0.03,
        posts=481,
    )
    plan = survey(
        ground=hills, type="fixed_wing", autopilot="ardupilot", airspeed_m_s=20.0,
        min_turn_radius_m=100.0, settle_m=150.0,
    )  # fmt: skip
    assert plan.hard_violations == ()
    heading_deg = plan.paths[0].take_off_heading_deg
    assert heading_deg is not None
    own = {**arduplane.PARAMETERS, **ARDUPILOT, **calibrated(arduplane.HOME_ALTITUDE_M + HEIGHT_M)}
    async with (
        arduplane.aeroplane(tmp_path, plan.home, 20.0, own, heading_deg=heading_deg) as client,
        ready(client, plan, arduplane.HOME_ALTITUDE_M),
    ):
        flight = await arduplane.fly(client)
    taken = judged("ArduPlane, over hills", plan, flight, HILLY_WITHIN)
    over_m = [
        photo.altitude_amsl_m - float(hills.heights_at([photo.lon_deg, photo.lat_deg])) for photo in taken
    ]
    planned_m = [
        up_m - float(hills.heights_at([lon, lat]))
        for photos in plan.photos
        for lon, lat, up_m in photos.places
    ]
    log.info(
        "| over the ground | %.0f–%.0f m planned | %.0f–%.0f m flown |",
        *(bound(each) for each in (planned_m, over_m) for bound in (min, max)),
    )
    assert min(over_m) > min(planned_m) - HELD_M
    assert max(over_m) < max(planned_m) + HELD_M


@pytest.mark.ardupilot
@pytest.mark.skipif(not COPTER, reason="SWATHPLAN_ARDUCOPTER names no simulator")
async def test_arducopter_takes_the_photos_planned(tmp_path: Path) -> None:
    """The same, from one corner to the next."""
    plan = survey(type="multirotor", autopilot="ardupilot", airspeed_m_s=10.0)
    defaults = os.environ.get("SWATHPLAN_ARDUCOPTER_PARAMS", str(Path(COPTER).with_name("copter.parm")))
    own = {**arduplane.PARAMETERS, **ARDUPILOT}
    async with (
        arduplane.aeroplane(
            tmp_path, plan.home, 15.0, own, model="+", binary=COPTER, defaults=defaults
        ) as client,
        ready(client, plan, arduplane.HOME_ALTITUDE_M),
    ):
        flight = await hovering(client)
    judged("ArduCopter, by distance", plan, flight)


@pytest.mark.px4
@pytest.mark.skipif(
    not (px4.BINARY and px4.ROMFS), reason="SWATHPLAN_PX4 and SWATHPLAN_PX4_ROMFS name no simulator"
)
@pytest.mark.parametrize("airframe", [px4.AEROPLANE, px4.MULTIROTOR])
async def test_px4_takes_the_photos_planned(tmp_path: Path, airframe: str) -> None:
    """Its own trigger by distance, on wings and on rotors."""
    wing = {"type": "fixed_wing", "airspeed_m_s": 14.0, "min_turn_radius_m": 100.0, "settle_m": 150.0}
    rotors = {"type": "multirotor", "airspeed_m_s": 8.0}
    plan = survey(autopilot="px4", **(wing if airframe == px4.AEROPLANE else rotors))
    async with (
        px4.simulated(tmp_path, plan.home, 10.0, PX4, airframe) as client,
        ready(client, plan, px4.HOME_ALTITUDE_M),
    ):
        flight = await px4.fly(client)
    judged("PX4, wing" if airframe == px4.AEROPLANE else "PX4, multirotor", plan, flight)


async def broken_off(client: VehicleClient, plan: Plan, how: str) -> tuple[int, int, int]:
    """A pass broken off: photos before it, in 15 s behind it, and in 15 s behind the order to stop."""
    recorder = client.start_recording()

    def taken() -> int:
        return len(recorder.track().photos)

    async def later(seconds: float) -> None:
        begun_s = client.state.time_s or 0.0
        await client.wait_for(lambda state: (state.time_s or 0.0) >= begun_s + seconds, 120.0)

    async with asyncio.timeout(240.0):
        while taken() < 10:
            await asyncio.sleep(0.05)
    if how == "return":
        assert (await client.return_to_launch()).accepted
        await client.wait_for(lambda state: "RTL" in state.mode, PATIENCE_S)
    else:
        # Without its passes: nothing of it switches the camera.
        items = [item for item in encode(plan).mission if item.command != Command.DO_SET_CAM_TRIGG_DIST]
        numbered = tuple(replace(item, seq=seq) for seq, item in enumerate(items))
        assert (await client.upload(numbered, MissionType.MISSION)).kind == "accepted"
    before = taken()
    await later(15.0)
    behind = taken() - before
    payload = payload_of(plan, "uav-1", None)
    assert (await client.switch_off(payload)).accepted
    await later(1.0)
    stopped = taken()
    await later(15.0)
    client.stop_recording(recorder)
    return before, behind, taken() - stopped


@pytest.mark.ardupilot
@pytest.mark.skipif(not arduplane.BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator")
@pytest.mark.parametrize("how", ["return", "replaced"])
async def test_arduplane_goes_on_with_photos_until_it_is_told(tmp_path: Path, how: str) -> None:
    """Whoever breaks a pass off by a return or another mission has to stop the camera; one order does."""
    plan = survey(
        type="fixed_wing", autopilot="ardupilot", airspeed_m_s=20.0, min_turn_radius_m=100.0, settle_m=150.0
    )
    heading_deg = plan.paths[0].take_off_heading_deg
    assert heading_deg is not None
    own = {**arduplane.PARAMETERS, **ARDUPILOT}
    async with (
        arduplane.aeroplane(tmp_path, plan.home, 8.0, own, heading_deg=heading_deg) as client,
        ready(client, plan, arduplane.HOME_ALTITUDE_M),
    ):
        await arduplane.arm(client)
        assert (await client.start_mission()).accepted
        before, behind, stopped = await broken_off(client, plan, how)
    log.info("ArduPlane, %s: %d photos, then %d, %d behind the order", how, before, behind, stopped)
    assert behind > 5
    assert stopped == 0


@pytest.mark.px4
@pytest.mark.skipif(
    not (px4.BINARY and px4.ROMFS), reason="SWATHPLAN_PX4 and SWATHPLAN_PX4_ROMFS name no simulator"
)
@pytest.mark.parametrize("how", ["return", "replaced"])
async def test_px4_ends_its_photos_with_the_mission(tmp_path: Path, how: str) -> None:
    """It stops its trigger where it leaves the mission; the order to stop is taken all the same."""
    plan = survey(autopilot="px4", type="multirotor", airspeed_m_s=8.0)
    async with (
        px4.simulated(tmp_path, plan.home, 6.0, PX4, px4.MULTIROTOR) as client,
        ready(client, plan, px4.HOME_ALTITUDE_M),
    ):
        for _ in range(120):
            if (await client.start_mission()).accepted:
                break
            await asyncio.sleep(0.5)
        before, behind, stopped = await broken_off(client, plan, how)
    log.info("PX4, %s: %d photos, then %d, %d behind the order", how, before, behind, stopped)
    assert behind <= 1
    assert stopped == 0
