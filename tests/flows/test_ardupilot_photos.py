"""What the photos of a real ArduPlane saw, by the attitude each reported: all of the region, in wind too.

Skipped unless ``SWATHPLAN_ARDUPLANE`` names the simulator; see ``arduplane.py``. ``pytest
--log-cli-level=INFO`` shows a row for each flight.
"""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from app.services.flights.photos import photos_of
from app.services.flights.seen import seen_by
from app.services.vehicles.recorder import flight_event
from mavlink.encoding.encode import EncodeOptions, encode
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.flows.arduplane import BINARY, HOME_ALTITUDE_M, aeroplane, fly, in_wind
from tests.flows.flying import WIND, store
from tests.flows.test_ardupilot_phases import calibrated, rates
from tests.planner.as_flown.test_photos import asked

log = logging.getLogger(__name__)

pytestmark = [
    pytest.mark.ardupilot,
    pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator"),
]

#: A camera on a servo.
CAMERA = {"CAM1_TYPE": 1, "SERVO9_FUNCTION": 10}


@pytest.mark.parametrize("from_deg", [None, WIND[1]])
async def test_the_region_is_seen_photo_by_photo(tmp_path: Path, from_deg: float | None) -> None:
    """With its autopilot's margins: 99.9 % within the distance sampled that was planned, no photo lost."""
    document, wind = asked(), None if from_deg is None else (WIND[0], from_deg)
    document["vehicles"][0] |= {"autopilot": "ardupilot", "finish": "land"}
    document["vehicles"][0].pop("settle_m", None)
    if wind is not None:
        document["wind"] = {"speed_m_s": wind[0], "from_deg": wind[1]}
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    mission = encode(plan, options=EncodeOptions(home_altitude_m=HOME_ALTITUDE_M))
    parameters = {**in_wind(wind), **rates(wind), **calibrated(HOME_ALTITUDE_M + plan.altitude_m), **CAMERA}
    heading_deg = plan.paths[0].take_off_heading_deg
    assert heading_deg is not None
    async with aeroplane(tmp_path, plan.home, 30.0, parameters, heading_deg=heading_deg) as client:
        await store(client, mission)
        flight = await fly(client)
    photos = photos_of([flight_event(event) for event in flight.track.events])
    found = seen_by(scenario, plan, flight.samples(), photos)
    assert found.photos is not None
    region = found.photos.regions["A"]
    assert None not in (region.forward.least, region.side.least, region.gsd_worst_m)
    log.info(
        "| %s | %d of %d | %.4f | %.4f, planned %.4f | %.3f, %.3f | %.3f, %.3f | %.2f, %.2f cm |",
        "none" if wind is None else f"{wind[0]:g} m/s",
        found.photos.counted,
        sum(each.planned for each in found.photos.passes),
        found.fraction["A"],
        region.overlap_fraction,
        region.planned_overlap_fraction,
        region.forward.least,
        region.forward.mean,
        region.side.least,
        region.side.mean,
        100.0 * (region.gsd_worst_m or 0.0),
        100.0 * region.limit_m,
    )
    assert found.fraction["A"] >= 0.999
    assert found.photos.counted == found.photos.taken > 0
    assert not any(each.lost for each in found.photos.passes)
