"""Strips of flights moved together: kernels against their plain twins, and laws of what is found."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import box

from planner.geojson import read_scenario
from planner.progress import never
from planner.search.moving.strip_kernels import COLUMNS, cost_m, look, passed
from planner.search.moving.together import Flier, Together
from planner.search.programme import seen_worth
from planner.search.values import Worth
from planner.tasks.setting import Setting
from planner.tasks.sought import asked_of
from tests.planner.search.searches import RADAR, WING, document


def asked_by(**members):
    """The search of 1200 m by 900 m by one aircraft in wind."""
    wind = {"wind": {"speed_m_s": 5.0, "from_deg": 230.0}}
    scenario = read_scenario(document(**wind, **members) | {"vehicles": [WING]})
    return asked_of(scenario, Setting.of(scenario))


@pytest.mark.parametrize("sensor", [{}, {"sensors": [RADAR]}])
def test_passes_costs_and_looks_are_those_of_the_plain_twins(sensor):
    """Random strips: where passes lie, what a flight costs and what it sees, as Python has them."""
    asked, wide = asked_by(**sensor), box(-9000.0, -9000.0, 9000.0, 9000.0)
    asked = replace(asked, room=replace(asked.room, free=wide, turning=wide))
    rng = np.random.default_rng(3)
    for side in asked.looking.looks:
        flier = Flier(asked.looking, side, asked.room, asked.pricing)
        table, flight = flier.table(np.eye(2)), flier.numbers()
        flight[:4] = (*asked.pricing.start, *asked.pricing.end)
        middles, ways = rng.uniform(-200.0, 200.0, (6, 1, 2)), rng.uniform(-150.0, 150.0, (6, 2))
        strips = middles + np.stack([-ways, ways], axis=1)
        rows = np.empty((len(strips), COLUMNS))
        sweeps = []
        for k, strip in enumerate(strips):
            course = math.atan2(*(strip[1] - strip[0])[::-1])
            swath = asked.looking.swath(course, side)
            assert passed(strip, table, flight[5], rows[k])
            (sweep,) = asked.sweeps_over(strip[None], side)
            assert rows[k, [0, 1, 8, 9]] == pytest.approx([*sweep.start, *sweep.end], abs=0.5)
            assert swath.nominal is not None
            assert swath.nominal.width_m >= swath.width_m - 1e-6
            sweeps.append(sweep)
        known_m = asked.pricing.cost_m(sweeps)
        assert cost_m(rows, len(rows), flight, table) == pytest.approx(known_m, rel=3e-3)
        scores = rng.uniform(0.0, 1.0, (90, 120))
        worth = Worth(scores, -600.0, -450.0, 10.0)
        looks, pays = np.zeros(scores.shape, dtype=np.int64), np.array([0.7, 0.7 * 0.3, 0.7 * 0.09])
        gained = sum(look(looks, scores, pays, -600.0, -450.0, 10.0, row, 1) for row in rows)
        assert gained == pytest.approx(seen_worth([s.nominal for s in sweeps], worth, 0.7), rel=0.02)
        taken = sum(look(looks, scores, pays, -600.0, -450.0, 10.0, row, -1) for row in rows)
        assert taken == pytest.approx(-gained)
        assert not looks.any()


def test_what_a_pass_sees_is_its_footprint():
    """The nominal swath is as large as the footprint that the judge takes, on every course."""
    asked = asked_by()
    for course in np.linspace(0.0, 2.0 * math.pi, 17):
        end = (800.0 * math.cos(course), 800.0 * math.sin(course))
        swath = asked.looking.swath(float(course), "down").nominal
        assert swath is not None
        seen_m2 = swath.width_m * (800.0 - swath.run_in_m - swath.run_out_m)
        assert asked.looking.collect((0.0, 0.0), end, "down").footprint.area == pytest.approx(
            seen_m2, rel=0.01
        )


def test_gaps_between_lanes_are_told():
    """Lanes along the ground, some metres apart, find what polygons of their footprints say, and no more."""
    asked, wide = asked_by(), box(-9000.0, -9000.0, 9000.0, 9000.0)
    asked = replace(asked, room=replace(asked.room, free=wide, turning=wide))
    flier = Flier(asked.looking, "down", asked.room, asked.pricing)
    together = Together(asked.ground, lambda places, _: np.ones(places.shape[:2]), 1.0, [flier])
    west, south, east, north = asked.ground.bounds
    nominal = asked.looking.swath(0.0, "down").nominal
    assert nominal is not None
    told, known = [], []
    for gap_m in (0.0, 3.0, 6.0):
        rows = np.arange(south + 0.5 * nominal.width_m, north, nominal.width_m + gap_m)
        lanes = np.array([[[west - 300.0, row], [east + 300.0, row]] for row in rows])
        sweeps = list(asked.sweeps_over(lanes, "down"))
        prints = [asked.looking.collect(s.start, s.end, s.look).footprint for s in sweeps]
        told.append(together.told(sweeps))
        known.append(shapely.union_all(prints).intersection(asked.ground).area)
    assert told == pytest.approx(known, rel=0.003)
    assert known[2] < 0.99 * known[0]


@pytest.mark.parametrize("mirrored", [False, True])
def test_ground_and_room_drawn_otherwise_are_the_same_numbers(mirrored):
    """Turned or mirrored, begun at another corner, with vertices on its edges: what strips are moved over."""
    asked = asked_by()
    zone = shapely.Polygon([(300.0, 200.0), (420.0, 230.0), (380.0, 330.0)])
    free = box(-400.0, -300.0, 1900.0, 1500.0).difference(zone)
    axes = np.array([[math.cos(0.7), math.sin(0.7)], [-math.sin(0.7), math.cos(0.7)]])
    axes = axes * [[-1.0, 1.0]] if mirrored else axes

    def put(places):
        return places @ axes + (40.0, -70.0)

    def numbers(ground, free, start, moved):
        (e, n) = moved(np.array([start]))[0].tolist()
        model = asked.pricing.model
        calm = replace(model, wind=replace(model.wind, speed_m_s=0.0))
        pricing = replace(asked.pricing, model=calm, start=(e, n), end=(e, n))
        room = replace(asked.room, free=free, turning=free.buffer(-60.0, join_style="mitre"))
        flier = Flier(asked.looking, "down", room, pricing)
        return Together(ground, lambda places, _: np.ones(places.shape[:2]), 1.0, [flier])

    plain = numbers(asked.ground, free, (100.0, 30.0), lambda places: places)
    whole, other = (
        shapely.transform(shapely.segmentize(shape, 170.0).reverse(), put) for shape in (asked.ground, free)
    )
    turned = numbers(whole, other, (100.0, 30.0), put)
    for name in ("_flights", "_scores", "_corner", "_widths_m"):
        assert getattr(turned, name) == pytest.approx(getattr(plain, name)), name
    for name in ("_free", "_turning"):
        assert getattr(turned, name)[0] == pytest.approx(getattr(plain, name)[0]), name


def test_strips_keep_to_the_budget_and_the_room():
    """All passes may be flown where the plain room says so, and cost no more than the budget."""
    asked = asked_by()
    flier = Flier(asked.looking, "down", asked.room, asked.pricing)
    together = Together(asked.ground, lambda places, _: np.ones(places.shape[:2]), 1.0, [flier, flier])
    found = together.found([4000.0, 5000.0], 0.1, 0, never, never)[0]
    for strips, budget_m in zip(together.lines(found), (4000.0, 5000.0), strict=True):
        assert len(strips)
        sweeps = list(asked.sweeps_over(strips, "down"))
        assert len(sweeps) == len(strips)
        assert asked.pricing.cost_m(sweeps) <= budget_m * 1.003
        assert all(asked.room.free.covers(shapely.linestrings([s.start, s.end])) for s in sweeps)
