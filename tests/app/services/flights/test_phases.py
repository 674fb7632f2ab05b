"""Phases of a flight as recorded: found where the plan has them, whatever time they took."""

from __future__ import annotations

import numpy as np
import pytest

from app.services.flights.phases import flown_phases
from app.services.records import TrackSample
from planner.geojson import read_scenario
from planner.pipeline import make_plan as flight_plan
from planner.plan import FlownPath
from tests.mavlink.plans import make_plan
from tests.planner.scenarios import small


def recorded(path: FlownPath, slower: float, from_s: float = 100.0) -> list[TrackSample]:
    """The path's own line, flown evenly in its duration by a factor, a place every half second; then rest."""
    lons, lats, altitudes_m = np.array(path.line).T
    east_m, north_m = (lons - lons[0]) * 92_800.0, (lats - lats[0]) * 111_100.0
    steps_m = np.sqrt(np.diff(east_m) ** 2 + np.diff(north_m) ** 2 + np.diff(altitudes_m) ** 2)
    along_m = np.concatenate([[0.0], np.cumsum(steps_m)])
    times_s = np.arange(0.0, path.duration_s * slower + 2.0, 0.5)
    at_m = times_s / (path.duration_s * slower) * along_m[-1]
    columns = [np.interp(at_m, along_m, values) for values in (lons, lats, altitudes_m)]
    return [
        TrackSample(from_s + time_s, lon, lat, None, height_m, None, None, None, None, sensor_on=False)
        for time_s, lon, lat, height_m in zip(times_s, *columns, strict=True)
    ]


@pytest.mark.parametrize("kind", ["fixed_wing", "multirotor", "vtol"])
@pytest.mark.parametrize("slower", [1.0, 1.3])
def test_phases_are_found_where_they_are_planned(kind: str, slower: float) -> None:
    """Flown evenly, every phase takes its share of the whole."""
    (path,) = make_plan(vehicle_type=kind).paths
    found = flown_phases(path, recorded(path, slower))
    assert [phase.kind for phase in found] == [phase.kind for phase in path.phases]
    for phase in found:
        assert phase.flown_s == pytest.approx(slower * phase.planned_s, abs=3.0)


def test_what_was_not_recorded_is_unknown() -> None:
    """Without a track no phase has a duration; cut short, the phases behind the cut have none."""
    (path,) = make_plan().paths
    assert {phase.flown_s for phase in flown_phases(path, [])} == {None}
    samples = recorded(path, 1.0)
    cut = flown_phases(path, samples[: len(samples) // 2])
    assert cut[0].flown_s is not None
    assert cut[-1].flown_s is None


@pytest.fixture(scope="module")
def there_and_back() -> FlownPath:
    """Of a multirotor, from home to lanes and back."""
    document = small(altitude_m=90.0)
    document["features"] = [each for each in document["features"] if each["id"] != "B"]
    document["sensors"] = [{"name": "eye", "type": "camera", "model": "Sony RX1R II", "min_interval_s": 0.0}]
    document["vehicles"][0] |= {"type": "multirotor", "autopilot": "px4", "airspeed_m_s": 10.0}
    (path,) = flight_plan(read_scenario(document)).paths
    return path


def test_what_lands_where_it_took_off_passes_each_height_twice(there_and_back: FlownPath) -> None:
    """A multirotor planned from home and back: its climb and its mission are not taken for the landing."""
    path = there_and_back
    assert path.line[0][:2] == pytest.approx(path.line[-1][:2], abs=1e-5)
    for phase in flown_phases(path, recorded(path, 1.1)):
        if phase.kind == "mission":
            assert phase.flown_s == pytest.approx(1.1 * phase.planned_s, rel=0.15)


def test_a_plan_joined_or_left_in_the_air_is_told_by_what_was_flown_of_it(there_and_back: FlownPath) -> None:
    """Half of a flight, as where a mission is replaced: no phase that was not flown whole has a duration."""
    samples = recorded(there_and_back, 1.0)
    half = len(samples) // 2
    left = {p.kind: p.flown_s for p in flown_phases(there_and_back, samples[:half])}
    joined = {p.kind: p.flown_s for p in flown_phases(there_and_back, samples[half:])}
    assert {kind for kind, flown_s in left.items() if flown_s is not None} == {"take_off", "climb"}
    assert {kind for kind, flown_s in joined.items() if flown_s is not None} == {"landing"}


def test_flights_that_begin_in_the_air_are_told_by_phase() -> None:
    """Their line begins at the height they fly at, from which home's is not to be taken."""
    document = small()
    document["vehicles"][0] |= {
        "finish": "land",
        "in_flight": {"lon_deg": -0.015, "lat_deg": -0.015, "height_m": 500.0, "heading_deg": 45.0},
    }
    plan = flight_plan(read_scenario(document))
    (path,), (vehicle,) = plan.paths, plan.vehicles
    assert vehicle.home_altitude_m is not None
    for phase in flown_phases(path, recorded(path, 1.1), vehicle.home_altitude_m):
        assert phase.flown_s == pytest.approx(1.1 * phase.planned_s, rel=0.15), phase
