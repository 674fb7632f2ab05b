"""What passes find of something that drifts, against a plain loop and against the judge."""

import math
from time import monotonic

import numpy as np
import pytest
import shapely
from scipy.stats import norm
from shapely.geometry import box

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.search.belief.drifting import Drifting, believed
from planner.search.kernels import drifting_gains, take_looks
from planner.search.programme import Pricing, Sweep, seen_worth
from planner.search.values import Swath, Worth
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.model import FlightModel
from planner.wishes import Drift, Importance, ImportancePatch, ImportancePoint, ImportanceRaster
from tests.planner.search.searches import WING, document, feature, lonlat, rectangle

STILL = Drift(0.0, 0.0)
MODEL = FlightModel(Aircraft("uav", "fixed_wing", "ardupilot", 16.0, 40.0))


def random_sweeps(rng, count):
    ends = rng.uniform(-400.0, 400.0, (count, 4))
    swath = Swath(-60.0, 45.0, -20.0, 10.0)
    return [Sweep((a, b), (c, d), "down", swath) for a, b, c, d in ends.tolist()]


def test_looks_again_find_a_part_of_what_was_missed():
    """The compiled looks leave of each cell what a plain count of them leaves."""
    rng = np.random.default_rng(3)
    worth = Worth(rng.random((41, 29)), -150.0, -210.0, 11.0)
    sweeps = random_sweeps(rng, 12)
    looks = sum(sweep.sees(worth.centres_m).astype(int) for sweep in sweeps)
    left = np.ones(worth.scores.shape)
    take_looks(left, worth.west_m, worth.south_m, worth.cell_m, np.array([s.row for s in sweeps]), 0.3)
    assert left == pytest.approx(0.3**looks)
    found = (worth.scores * (1.0 - 0.3**looks)).sum() * 121.0
    assert seen_worth(sweeps, worth, 0.7) == pytest.approx(found)


def test_what_drifts_is_looked_at_where_it_then_is():
    """Each pass finds the places that a flight in small steps comes abeam of within the swath."""
    rng = np.random.default_rng(8)
    sweep = Sweep((-300.0, -200.0), (350.0, 150.0), "down", Swath(-60.0, 45.0, -20.0, 10.0))
    speed, begin_s = 14.0, 500.0
    drifts = rng.uniform(-0.8, 0.8, (600, 2))
    places = rng.uniform(-400.0, 400.0, (600, 2)) - begin_s * drifts
    times_s = begin_s + np.linspace(0.0, sweep.length_m / speed, 20_001)
    ours = np.asarray(sweep.start) + (times_s - begin_s)[:, None] * speed * sweep.along
    found = []
    for place, drift in zip(places, drifts, strict=True):
        there = place + times_s[:, None] * drift
        nearest = int(np.argmin(np.abs((there - ours) @ sweep.along)))
        found.append(bool(sweep.sees(there[nearest])))
    left = np.ones(600)
    flown = (np.array([begin_s]), np.array([sweep.length_m]), np.array([speed]))
    (gain,) = drifting_gains(left, places, drifts, np.array([sweep.row]), *flown, 0.25)
    assert 50 < sum(found) < 550
    # A place within a step of the edge may fall either way.
    assert np.count_nonzero((left < 1.0) != np.array(found)) <= 1
    assert gain == pytest.approx(0.75 * np.count_nonzero(left < 1.0))


def test_places_stand_for_all_kinds_of_importance():
    """What is believed has each source's worth where the source has it, drift and time added."""
    raster = ImportanceRaster("r", np.array([[0.0, 2.0], [1.0, 1.0]]), 5000.0, 0.0, 100.0)
    patch = ImportancePatch(
        "p", box(-3000.0, 0.0, -2900.0, 400.0).union(box(-2900.0, 0.0, -2800.0, 100.0)), 3.0
    )
    point = ImportancePoint("k", (0.0, 10.0), 200.0, 0.5)
    drift = Drift(0.2, -0.4, 0.1, 1000.0)
    importance = Importance((patch,), raster, (point,), drift=drift)
    belief = believed(importance, drift, 4096)
    total = 40_000.0 + 3.0 * 50_000.0 + point.total
    assert belief.weights.sum() == pytest.approx(total)
    here = belief.places_m[:, 0]
    ofpoint, ofraster = np.abs(here) < 2000.0, here > 2000.0
    assert belief.weights[ofraster].sum() == pytest.approx(40_000.0)
    assert belief.weights[ofpoint].sum() == pytest.approx(point.total)
    mean = belief.weights[ofpoint] @ belief.places_m[ofpoint] / point.total
    assert mean == pytest.approx([200.0, 10.0 - 400.0], abs=5.0)
    spread = belief.places_m[ofpoint].std(axis=0)
    assert spread == pytest.approx([math.hypot(200.0, 100.0)] * 2, rel=0.02)
    then = belief.places_m - drift.elapsed_s * belief.drifts_m_s
    left = then[here < -2000.0]
    assert shapely.contains_xy(patch.area, left[:, 0], left[:, 1]).all()
    assert left.mean(axis=0) == pytest.approx([patch.area.centroid.x, patch.area.centroid.y], abs=3.0)


def test_one_pass_over_a_normal_finds_what_a_table_says():
    """A pass through the middle, half a spread to each side, finds p (2 Φ(½) − 1)."""
    importance = Importance(points=(ImportancePoint("k", (0.0, 0.0), 100.0, 1.0),), drift=STILL)
    drifting = Drifting(believed(importance, STILL, 2048), 0.6, 0.0, 1e12)
    sweep = Sweep((-2000.0, 0.0), (2000.0, 0.0), "down", Swath(-50.0, 50.0, 0.0, 0.0))
    share = drifting.found([sweep], Pricing(MODEL, (0.0, 0.0), (0.0, 0.0))) / drifting.total
    assert share == pytest.approx(0.6 * (norm.cdf(0.5) - norm.cdf(-0.5)), rel=0.01)


def known(**search):
    """A last known point over an area that is large enough to drift in."""
    point = feature("importance", "Point", lonlat(600.0, 450.0), score=1.0, spread_m=150.0, name="K")
    asked = document(point, search=search, method={"search": "creeping"}, vehicle=WING | {"energy_wh": 40})
    asked["features"][0] = rectangle("area", -1500.0, -1500.0, 2500.0, 2500.0)
    return asked


def test_the_search_goes_where_the_drift_leads():
    """Passes lie about where the missing one is by then; the judge finds what the planner thought, and more
    than it would of something that drifts elsewhere."""
    drift = {"speed_m_s": 0.6, "toward_deg": 90.0, "spread_m_s": 0.05, "elapsed_s": 900.0}
    scenario = read_scenario(known(detection=0.8, drift=drift))
    plan = make_plan(scenario)
    assert plan.violations == ()
    middle = np.mean(
        [scenario.frame.to_local([p[:2] for p in each.line]) for each in plan.collects], axis=(0, 1)
    )
    datum = np.array(scenario.importance.points[0].position)
    east_m, north_m = scenario.frame.north_up(middle - datum)
    assert 400.0 < east_m < 1300.0
    assert abs(north_m) < 200.0
    share = plan.metrics.importance_collected / plan.metrics.importance_total
    assert 0.5 < share < 1.0
    other = read_scenario(known(detection=0.8, drift=drift | {"toward_deg": 270.0}))
    assert make_plan(other).metrics.importance_collected != plan.metrics.importance_collected


def test_a_sensor_that_misses_looks_again():
    """Small ground is seen by more passes where looks miss, and each finds a part of the rest."""
    point = rectangle("importance", 500.0, 300.0, 700.0, 500.0, score=2.0, name="I")
    roi = rectangle("roi", 500.0, 300.0, 700.0, 500.0, name="G")
    asked = [document(roi, point, search={"detection": p}, time_budget_s=2.0) for p in (1.0, 0.5)]
    sure, unsure = (make_plan(read_scenario(each), clock=monotonic) for each in asked)
    assert len(unsure.collects) > len(sure.collects)
    assert sure.metrics.importance_collected == pytest.approx(sure.metrics.importance_total, rel=1e-3)
    assert 0.75 < unsure.metrics.importance_collected / unsure.metrics.importance_total < 1.0
