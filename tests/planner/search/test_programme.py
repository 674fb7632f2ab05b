"""Passes by what they see and cost: the kernel against its plain twin, cuts against budgets."""

import math

import numpy as np
import pytest
from shapely.geometry import box

from planner.search.choose import Search
from planner.search.programme import Pricing, Programme, Sweep, cut_to, seen_worth, thinned_to
from planner.search.room import Room
from planner.search.values import Swath, Worth, worth_of_ground
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.model import FlightModel

MODEL = FlightModel(Aircraft("uav", "fixed_wing", "ardupilot", 16.0, 40.0))
SWATH = Swath(-30.0, 30.0, -10.0, -10.0)
PRICING = Pricing(MODEL, (0.0, 0.0), (0.0, 0.0))
WIDE = box(-5000.0, -5000.0, 5000.0, 5000.0)
EVERYWHERE = Room(WIDE, WIDE, MODEL.turn_radius_m, 0.0)


class Below:
    """A sensor that sees the same on every course."""

    looks = ("down",)

    def swath(self, _course_rad, _look):
        """The swath of all tests here."""
        return SWATH


LANES = tuple(
    Sweep((50.0, y), (950.0, y), "down", SWATH) if k % 2 == 0 else Sweep((950.0, y), (50.0, y), "down", SWATH)
    for k, y in enumerate(range(30, 600, 60))
)


def test_cells_seen_are_those_that_a_plain_loop_finds():
    """The compiled marking sees the cells that each pass says it sees, and no others."""
    rng = np.random.default_rng(5)
    worth = Worth(rng.random((37, 53)), -120.0, 40.0, 9.0)
    for _ in range(40):
        ends = rng.uniform(-200.0, 500.0, (3, 4))
        edges = np.sort(rng.uniform(-90.0, 90.0, 2))
        swath = Swath(*edges.tolist(), *rng.uniform(-30.0, 30.0, 2).tolist())
        sweeps = [Sweep((e[0], e[1]), (e[2], e[3]), "down", swath) for e in ends.tolist()]
        plain = np.logical_or.reduce([sweep.sees(worth.centres_m) for sweep in sweeps])
        assert seen_worth(sweeps, worth) == pytest.approx(worth.scores[plain].sum() * 81.0)


@pytest.mark.parametrize("budget_m", [0.0, 700.0, 2500.0, 4321.0, 9000.0, 1e9])
def test_cuts_keep_the_budget_and_use_it(budget_m):
    """What is cut to a budget costs no more, and one pass more would."""
    kept = cut_to(LANES, PRICING, budget_m)
    assert not kept or PRICING.cost_m(kept) <= budget_m + 1e-6
    if kept and len(kept) < len(LANES):
        whole = (*LANES[: len(kept)],) if kept[-1] != LANES[len(kept) - 1] else LANES[: len(kept) + 1]
        assert PRICING.cost_m(whole) > budget_m


def test_costs_are_those_of_the_line_itself():
    """Two lanes cost their lengths, a half circle between them, and the ways there and back."""
    radius = MODEL.turn_radius_m
    beside_m = LANES[0].start[1] + 2.0 * radius
    first, second = LANES[0], Sweep((950.0, beside_m), (50.0, beside_m), "down", SWATH)
    there = PRICING.cost_m([first]) - PRICING.homeward_m(PRICING.poses([first])[1])[0]
    back = PRICING.homeward_m(PRICING.poses([second])[1])[0]
    turn = PRICING.cost_m([first, second]) - there - second.length_m - back
    assert turn == pytest.approx(math.pi * radius, rel=0.01)


def test_thinning_leaves_out_what_is_worth_least():
    """Lanes over worthless ground go first, and what is kept is in the budget: 920 m each of two lanes."""
    ground = box(0.0, 0.0, 1000.0, 600.0)
    scores = np.zeros((60, 100))
    scores[30:42] = 1.0
    worth = worth_of_ground(ground, 10.0, scores)
    kept = thinned_to(LANES, PRICING, 5000.0, np.array([seen_worth([lane], worth) for lane in LANES]))
    assert PRICING.cost_m(kept) <= 5000.0
    assert seen_worth(kept, worth) == pytest.approx(0.92 * worth.total)


def test_refined_strips_see_more():
    """Strips laid askew over what is worth seeing are turned and moved until they see more of it."""
    ground = box(0.0, 0.0, 1000.0, 600.0)
    scores = np.zeros((60, 100))
    scores[20:34] = 1.0
    worth = worth_of_ground(ground, 10.0, scores)
    strips = np.array([[[40.0, 180.0], [960.0, 260.0]], [[960.0, 330.0], [40.0, 250.0]]])
    asked = Search(ground, worth, Below(), EVERYWHERE, PRICING)
    sweeps = tuple(Sweep(tuple(a), tuple(b), "down", SWATH) for a, b in strips.tolist())
    laid = Programme("parallel", sweeps, seen_worth(sweeps, worth), 0.0, sweeps, False, strips, "down")
    found = asked._refined(laid, 6000.0, 60.0)
    assert found.worth > 1.1 * laid.worth
    assert PRICING.cost_m(found.sweeps) <= 6000.0
