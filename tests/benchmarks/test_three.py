"""Three simulated aircraft in the air at once: what is between them is measured, and told if too little."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pyproj import Geod

from app.services.plans.replanned import Changes
from benchmarks import three
from benchmarks.sky import STEP_S, FlightError
from mavlink.links.recording import read_tlog
from mavlink.wire.codec import Codec
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.wishes import Separation

KEPT = Separation(150.0, 30.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the flight is recorded."""
    return tmp_path_factory.mktemp("three")


@pytest.fixture(scope="module")
def flown(folder: Path) -> three.Together:
    """The example's flight, planned anew after five minutes."""
    document = json.loads((three._example(f"{three.NAME}.geojson")).read_text())
    told = json.loads((three._example(f"{three.NAME}-changes.json")).read_text())
    scenario = read_scenario(document)
    changes = Changes(told["add"], told["remove"])
    return three.flight(document, scenario, make_plan(scenario), changes, 300.0, 2.0, folder)


def test_all_fly_on_by_the_new_plan_see_what_is_left_and_land(flown: three.Together) -> None:
    """Each was given two missions, flew the second to its end; all that was left has been seen."""
    *each, total = flown.rows()
    assert [row["aircraft"] for row in each] == ["north", "middle", "south"]
    assert all(len(row["items"]) == 2 and row["landed"] for row in each)
    assert total["aloft"] == 3
    assert total["hard_violations"] == 0
    assert total["least_seen"] > 0.99
    flown.judge()


def test_the_record_shows_that_none_came_too_near(flown: three.Together, folder: Path) -> None:
    """By geodesics between the recorded places, look by look."""
    tracks = json.loads((folder / "tracks.geojson").read_text())["features"]
    at = {
        track["properties"]["vehicle"]: dict(
            zip(track["properties"]["times_s"], track["geometry"]["coordinates"], strict=True)
        )
        for track in tracks
    }
    geod = Geod(ellps="WGS84")
    least_m = math.inf
    for one, other in itertools.combinations(at, 2):
        both = sorted(at[one].keys() & at[other].keys())
        assert len(both) > 400.0 / STEP_S
        here, there = (np.array([at[name][time_s] for time_s in both]) for name in (one, other))
        across_m = geod.inv(here[:, 0], here[:, 1], there[:, 0], there[:, 1])[2]
        low = np.abs(here[:, 2] - there[:, 2]) < KEPT.vertical_m
        least_m = min(least_m, float(across_m[low].min(initial=math.inf)))
    assert least_m >= KEPT.horizontal_m
    # The bench also looks between two looks, where heights come to count: one step of two that meet.
    assert flown.nearest.across_m == pytest.approx(least_m, abs=2.0 * 40.0 * STEP_S)


def test_the_links_are_recorded_as_they_spoke(flown: three.Together, folder: Path) -> None:
    """In each recording both missions go up and are read back, item by item."""
    for name, each in flown.sky.aircraft.items():
        codec = Codec()
        (path,) = (folder / name).glob("*.tlog")
        heard = [message for _, frame in read_tlog(path) for message in codec.feed(frame)]
        counts = [m.integer("count") for m in heard if m.name == "MISSION_COUNT"]
        meant = [len(items) for items in each.given]
        assert counts == [meant[0], meant[0], meant[1], meant[1]]
        assert len([m for m in heard if m.name == "MISSION_ITEM_INT"]) == 2 * sum(meant)


def test_what_is_too_near_is_told(flown: three.Together) -> None:
    """Of a flight that is to keep more than it did, both are named with their distance."""
    wider = replace(flown.scenario, separation=Separation(flown.nearest.across_m + 10.0, 30.0))
    with pytest.raises(FlightError, match=f"{' and '.join(flown.nearest.of)} came within"):
        replace(flown, scenario=wider).judge()


def test_two_are_nearest_between_two_looks() -> None:
    """Lines that cross at a right angle, one a moment behind: the least is that of a thousandfold look."""
    times_s = STEP_S * np.arange(400)
    zeros = np.zeros_like(times_s)
    one = np.column_stack([times_s, 40.0 * times_s - 403.3, zeros, zeros + 300.0])
    other = np.column_stack([times_s, zeros, 55.0 * times_s - 541.0, zeros + 310.0])
    fine_s = np.linspace(0.0, times_s[-1], 400_000)
    exact_m = np.hypot(40.0 * fine_s - 403.3, 55.0 * fine_s - 541.0)
    across_m, at_s = three.near(one, other, KEPT)
    assert across_m == pytest.approx(exact_m.min(), abs=1e-3)
    assert at_s == pytest.approx(fine_s[exact_m.argmin()], abs=1e-3)
    assert across_m < min(np.hypot(*(one - other)[:, 1:3].T))


def test_height_alone_keeps_two_apart_and_only_as_long_as_it_lasts() -> None:
    """One descends past the other's height: only from there on they are near."""
    times_s = STEP_S * np.arange(200)
    zeros = np.zeros_like(times_s)
    still = np.column_stack([times_s, zeros, zeros, zeros + 300.0])
    over = np.column_stack([times_s, 20.0 * times_s, zeros, zeros + 331.0])
    assert three.near(still, over, KEPT)[0] == math.inf
    falling = over - np.outer(times_s, [0.0, 0.0, 0.0, 1.0])
    across_m, at_s = three.near(still, falling, KEPT)
    assert at_s == pytest.approx(1.0, abs=STEP_S)
    assert across_m == pytest.approx(20.0 * at_s, abs=1e-6)
    later = still + np.array([1000.0, 0.0, 0.0, 0.0])
    assert three.near(still, later, KEPT)[0] == math.inf
