"""What photos saw, held against images built from the test's own rotations and rays."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from shapely import contains_xy
from shapely.geometry import Polygon, box

from planner.as_flown.coverage import FlownCoverage
from planner.as_flown.photo import Photo, Shots, axes
from planner.as_flown.photo_ground import PhotoGrid
from planner.as_flown.track import Record, TrackSample
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan, PlanCamera
from planner.scenario import Scenario
from planner.tasks.flown import sortie_coverage
from tests.planner.scenarios import feature, small
from tests.planner.terrains import grid

HEIGHT_M, STEP_S = 150.0, 0.2
#: Flown straight before and behind each lane.
BEYOND_M = 20.0
CAMERA = PlanCamera("cam", 0.035, 4.5e-6, 6000, 4000, 0.75, 0.65, tilt_deg=0.0)


def asked(trigger: str = "distance") -> dict[str, Any]:
    """A scenario of one region of some lanes."""
    document = small()
    ring = [[0.0, 0.0], [0.002, 0.0], [0.002, 0.002], [0.0, 0.002], [0.0, 0.0]]
    document["features"][:2] = [feature("A", "roi", "Polygon", [ring])]
    document["altitude_m"] = HEIGHT_M
    camera: dict[str, Any] = {"focal_length_m": 0.035, "pixel_pitch_m": 4.5e-6, "image_px": [6000, 4000]}
    document["sensors"] = [{"name": "cam", "type": "camera", "trigger": trigger, **camera}]
    return document


@lru_cache
def planned(trigger: str = "distance") -> tuple[Scenario, Plan]:
    """The same, read and planned."""
    scenario = read_scenario(asked(trigger))
    return scenario, make_plan(scenario)


def record(
    trigger: str = "distance",
    lost: frozenset[tuple[int, int]] = frozenset(),
    roll_deg: float = 0.0,
    photos: bool = True,
    untold: bool = False,
    sensor_on: bool | None = True,
) -> Record:
    """Every lane flown on its line; photos as planned but for those lost, by lane and number there."""
    scenario, plan = planned(trigger)
    samples: list[TrackSample] = []
    taken: list[Photo] = []
    now_s, index = 0.0, 0
    for collect in plan.collects:
        first, last = scenario.frame.to_local([place[:2] for place in collect.line])
        length_m = math.dist(first, last)
        ahead = (last - first) / length_m
        steps_m = np.linspace(-BEYOND_M, length_m + BEYOND_M, int(length_m // 4.0) + 22)
        speed_m_s = (steps_m[1] - steps_m[0]) / STEP_S
        began_s = now_s + BEYOND_M / speed_m_s
        for lon, lat in scenario.frame.to_wgs84(first + steps_m[:, None] * ahead):
            samples.append(
                TrackSample(
                    now_s, float(lon), float(lat), HEIGHT_M, roll_deg, sensor_on, collect.heading_deg, 0.0
                )
            )
            now_s += STEP_S
        places = next((p.places for p in plan.photos if p.seq == collect.seq), ())
        for k, place in enumerate(places):
            at_s = began_s + length_m / speed_m_s * k / max(len(places) - 1, 1)
            gone = (collect.seq, k) in lost
            index += not gone or untold
            if not gone:
                told = (roll_deg, 0.0, collect.heading_deg)
                taken.append(Photo(at_s, place[0], place[1], HEIGHT_M, *told, "airframe", index))
        now_s += 20.0
    return Record(tuple(samples), plan.vehicles[0].name, None, tuple(taken) if photos else ())


def judged(one: Record, trigger: str = "distance") -> FlownCoverage:
    """One flight."""
    return sortie_coverage(*planned(trigger), (one,))


def image(place: NDArray[np.float64], angles_deg: tuple[float, float, float], camera: PlanCamera) -> Polygon:
    """The ground in one photo, by the rays through its corners: forward, right, down turned to the north."""
    wide = camera.columns * camera.pixel_pitch_m / camera.focal_length_m / 2.0
    high = camera.rows * camera.pixel_pitch_m / camera.focal_length_m / 2.0
    rays = np.array([[-high, -wide, 1.0], [-high, wide, 1.0], [high, wide, 1.0], [high, -wide, 1.0]])
    # The camera's tilt, and then the airframe's roll, pitch and yaw.
    tilted = Rotation.from_euler("Y", math.radians(camera.tilt_deg)).apply(rays)
    ned = Rotation.from_euler("ZYX", np.radians(angles_deg[::-1])).apply(tilted)
    assert (ned[:, 2] > 0.1).all()
    return Polygon(place[:2] + ned[:, 1::-1] / ned[:, 2:] * place[2])


@settings(max_examples=25, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.floats(-60.0, 60.0), st.floats(-60.0, 60.0), st.floats(80.0, 200.0),
            st.floats(-25.0, 25.0), st.floats(-20.0, 20.0), st.floats(0.0, 360.0),
        ),
        min_size=1,
        max_size=6,
    ),
    st.floats(-15.0, 15.0),
)  # fmt: skip
def test_a_photo_sees_what_its_rays_meet(
    photos: list[tuple[float, float, float, float, float, float]], tilt_deg: float
) -> None:
    """As many photos as the test's own outlines hold see each cell, those at their very edges aside."""
    camera = replace(CAMERA, tilt_deg=-tilt_deg)
    rows = np.array(photos)
    roll, pitch, yaw = np.radians(rows[:, 3:]).T
    shots = Shots(rows[:, :3], *axes(camera, roll, pitch, yaw, np.zeros(len(rows), dtype=bool)))
    cells = PhotoGrid.over(box(-80.0, -80.0, 80.0, 80.0), 60.0)
    cells.lay(shots, camera, None, 0.0)
    prints = [image(row[:3], (row[3], row[4], row[5]), camera) for row in rows]
    east, north = cells.middles[..., 0], cells.middles[..., 1]
    least = sum(contains_xy(print_.buffer(-1e-6), east, north).astype(int) for print_ in prints)
    most = sum(contains_xy(print_.buffer(1e-6), east, north).astype(int) for print_ in prints)
    assert ((cells.counts >= least) & (cells.counts <= most)).all()


@pytest.mark.parametrize("angles_deg", [(0.0, 0.0, 30.0), (8.0, 0.0, 100.0), (-5.0, 12.0, 250.0)])
def test_the_distance_sampled_is_what_a_pixel_covers(angles_deg: tuple[float, float, float]) -> None:
    """Over the middle of the image: the mean of both axes of the ellipse that a round pixel draws."""
    place = np.array([0.0, 0.0, HEIGHT_M])
    turn = Rotation.from_euler("ZYX", np.radians(angles_deg[::-1]))
    pixel = CAMERA.pixel_pitch_m / CAMERA.focal_length_m
    angles = np.linspace(0.0, math.tau, 721)
    ned = turn.apply(np.stack([pixel * np.cos(angles), pixel * np.sin(angles), np.ones(721)], axis=1))
    ring = ned[:, 1::-1] / ned[:, 2:] * HEIGHT_M
    middle = turn.apply([0.0, 0.0, 1.0])
    at = middle[1::-1] / middle[2] * HEIGHT_M
    reach_m = np.hypot(*(ring - at).T)
    wanted_m = (reach_m.max() + reach_m.min()) / 2.0
    roll, pitch, yaw = (np.array([angle]) for angle in np.radians(angles_deg))
    shots = Shots(place[None], *axes(CAMERA, roll, pitch, yaw, np.zeros(1, dtype=bool)))
    cells = PhotoGrid.over(box(at[0] - 1.0, at[1] - 1.0, at[0] + 1.0, at[1] + 1.0), 60.0)
    cells.lay(shots, CAMERA, None, 0.0)
    row, column = (size // 2 for size in cells.counts.shape)
    assert cells.finest_m[row, column] == pytest.approx(wanted_m, rel=0.005)


def test_a_hill_hides_what_lies_behind_it() -> None:
    """Ground in an oblique photo, behind a wall of forty metres, is not seen; before it it is."""
    camera = replace(CAMERA, tilt_deg=60.0)
    ground = grid(lambda e, n: np.where(np.abs(n - 200.0) < 6.0, 40.0, 0.0), 800.0, 5.0)
    level = np.zeros(1)
    ways = axes(camera, level, level, level, np.zeros(1, dtype=bool))
    shots = Shots(np.array([[0.0, 0.0, 100.0]]), *ways)
    cells = PhotoGrid.over(box(-5.0, 140.0, 5.0, 280.0), 200.0)
    cells.lay(shots, camera, ground, 0.0)
    seen = cells.counts[:, cells.counts.shape[1] // 2] > 0
    north = cells.middles[:, 0, 1]
    assert seen[(north > 145.0) & (north < 185.0)].all()
    assert not seen[(north > 220.0) & (north < 270.0)].any()


def test_flown_as_planned_all_is_seen_as_overlapping_as_planned() -> None:
    """To the last cell within the distance sampled that was planned, with both overlaps asked for."""
    found = judged(record())
    photos = found.photos
    assert photos is not None
    region = photos.regions["A"]
    assert found.fraction["A"] > 0.9999
    assert photos.taken == photos.counted == sum(len(p.places) for p in planned()[1].photos)
    assert all(not each.lost for each in photos.passes)
    assert region.forward.least is not None
    assert region.side.least is not None
    assert region.forward.least >= 0.75 - 1e-6
    assert region.side.least >= 0.65 - 1e-6
    assert region.overlap_fraction == pytest.approx(region.planned_overlap_fraction, abs=0.01)
    assert not found.not_counted


@pytest.mark.parametrize("sensor_shown", [True, False])
def test_ways_beside_a_lane_are_not_flown_for_it(sensor_shown: bool) -> None:
    """Flown 12 m beside every lane in its direction without photos, passes are as far off as with them."""
    scenario, _ = planned()
    one = record(sensor_on=sensor_shown)
    heading = math.radians(one.samples[0].heading_deg or 0.0)
    aside_m = 12.0 * np.array([math.cos(heading), -math.sin(heading)])
    later_s = one.samples[-1].time_s + 60.0
    places = scenario.frame.to_wgs84(
        scenario.frame.to_local([(s.lon_deg, s.lat_deg) for s in one.samples]) + aside_m
    )
    beside = tuple(
        replace(s, time_s=s.time_s + later_s, lon_deg=float(lon), lat_deg=float(lat), sensor_on=False)
        for s, (lon, lat) in zip(one.samples, places, strict=True)
    )
    passes = judged(replace(one, samples=one.samples + beside)).passes
    assert len(passes) == len(planned()[1].collects)
    assert max(each.cross_track_max_m for each in passes) < 0.1


def test_photos_that_are_lost_are_told_and_leave_ground_out() -> None:
    """A run of five in every lane: their number, and a band across the region."""
    _, plan = planned()
    lost = frozenset((p.seq, k) for p in plan.photos for k in range(5, 10))
    found = judged(record(lost=lost))
    assert found.photos is not None
    assert all(each.missing == 5 and each.planned - each.taken == 5 for each in found.photos.passes)
    assert found.fraction["A"] < 0.99
    assert found.unseen["A"].area > 100.0
    whole = found.unseen["A"].area + found.seen["A"].area
    assert whole == pytest.approx(planned()[0].regions[0].area.area, rel=1e-6)


def test_photos_that_nobody_heard_of_are_unknown() -> None:
    """Where the camera's count skips, photos were taken: their ground is neither seen nor missed."""
    lost = frozenset((p.seq, k) for p in planned()[1].photos for k in range(5, 10))
    found = judged(record(lost=lost, untold=True))
    assert found.photos is not None
    assert all(each.untold == 5 for each in found.photos.passes)
    assert found.unknown_fraction["A"] > 0.005
    assert found.unseen["A"].area < 1.0


def test_photos_that_no_autopilot_reports_are_assumed_and_prove_nothing() -> None:
    """With the whole flight flown: nothing is seen, all of it assumed, and so unknown."""
    found = judged(record(photos=False))
    assert found.photos is not None
    assert found.fraction["A"] == 0.0
    assert found.photos.taken == 0
    assert found.photos.assumed > 0
    area_m2 = planned()[0].regions[0].area.area
    assert found.photos.regions["A"].assumed.area > 0.99 * area_m2
    assert found.unknown_fraction["A"] > 0.999


@pytest.mark.parametrize(
    ("changed", "reason"),
    [({"roll_deg": None}, "attitude-unknown"), ({"height_m": math.nan}, "height-unknown"),
     ({"roll_deg": 50.0}, "turned")],
)  # fmt: skip
def test_what_shows_not_where_it_looked_does_not_count(changed: dict[str, Any], reason: str) -> None:
    """Without attitude, its own or the track's, without height, or turned away: its reason is told."""
    one = record()
    photos = tuple(replace(photo, **changed) for photo in one.photos)
    samples = (
        tuple(replace(s, roll_deg=math.nan) for s in one.samples) if "roll_deg" in changed else one.samples
    )
    found = judged(replace(one, photos=photos, samples=samples))
    assert found.photos is not None
    assert found.photos.not_counted == {reason: found.photos.taken}
    assert found.fraction["A"] == 0.0
    # Where a photo looked that was turned away is known.
    assert (found.unknown_fraction["A"] > 0.999) is (reason != "turned")


def test_a_mount_s_own_attitude_goes_before_the_airframe_s() -> None:
    """Of a camera that hangs straight down by itself, the airframe's roll is of no matter."""
    one = record(roll_deg=20.0)
    hanging = tuple(replace(p, roll_deg=0.0, pitch_deg=-90.0, attitude_of="camera") for p in one.photos)
    bolted, hung = judged(one), judged(replace(one, photos=hanging))
    assert bolted.fraction["A"] < 0.95
    assert hung.fraction["A"] > 0.9999


def test_a_camera_that_comes_in_a_gimbal_is_level_in_it() -> None:
    """The airframe leans by 25°: bolted on it a camera misses ground, in a gimbal of its own it does not."""
    scenario, plan = planned()
    leaning = record(roll_deg=25.0)
    bolted = judged(leaning)
    hanging = replace(plan, cameras=(replace(plan.cameras[0], model="DJI Phantom 4 Pro"),))
    level = sortie_coverage(scenario, hanging, (leaning,))
    upright = judged(record())
    assert bolted.fraction["A"] < 0.95
    assert level.fraction == upright.fraction


def test_a_stabilised_camera_is_level_unless_its_gimbal_says_otherwise() -> None:
    """As its scenario says nothing of leaning; what its own gimbal tells, 40° off, counts."""
    scenario, plan = planned()
    held = replace(scenario, sensors=tuple(replace(each, stabilised=True) for each in scenario.sensors))
    leaning = record(roll_deg=25.0)
    assert sortie_coverage(held, plan, (leaning,)).fraction == judged(record()).fraction
    aside = tuple(replace(p, roll_deg=0.0, pitch_deg=-50.0, attitude_of="camera") for p in leaning.photos)
    assert sortie_coverage(held, plan, (replace(leaning, photos=aside),)).fraction["A"] == 0.0


def test_a_photo_without_attitude_has_that_of_the_track() -> None:
    """Between two places of the record, like the photo's own."""
    one = record(roll_deg=6.0)
    bare = tuple(replace(p, roll_deg=None, pitch_deg=None, yaw_deg=None) for p in one.photos)
    told, untold = judged(one).photos, judged(replace(one, photos=bare)).photos
    assert told is not None
    assert untold is not None
    assert (told.regions["A"].grid.counts == untold.regions["A"].grid.counts).mean() > 0.999


@pytest.mark.parametrize("sensor_on", [True, False, None])
def test_a_video_sees_while_it_is_on(sensor_on: bool | None) -> None:
    """All of the region where it was on along all lanes; where nobody told whether it was, it is unknown."""
    found = judged(record("video", sensor_on=sensor_on), "video")
    assert found.photos is not None
    region = found.photos.regions["A"]
    area_m2 = planned("video")[0].regions[0].area.area
    assert found.fraction["A"] == pytest.approx(1.0 if sensor_on else 0.0, abs=1e-3)
    assert region.assumed.area == pytest.approx(area_m2 if sensor_on is None else 0.0, rel=1e-2)
    assert found.unknown_fraction["A"] == pytest.approx(1.0 if sensor_on is None else 0.0, abs=1e-3)
    assert found.unseen["A"].area == pytest.approx(0.0 if sensor_on is not False else area_m2, abs=10.0)
