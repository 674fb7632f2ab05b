"""What to leave out by the orienteering form: never less priority than greedily."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pytest
from shapely.geometry import Polygon

from planner.fleet.prizes.choice import Choices
from planner.route import CollectPass
from planner.tasks.limits import IN_EARNEST, TRIED_AGAIN, within_limits
from planner.tasks.prizes import Offer
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import Use, strain

Point = tuple[float, float]
HOME = (0.0, 0.0)
#: Of the toy's flights besides their way between places: what no estimate of routes knows of.
LIFT_M = 300.0
#: By how much flights planned in haste are longer.
HASTE = 1.01


@dataclass(frozen=True)
class Toy:
    """Places visited by the shortest round trip, and what that uses."""

    passes: tuple[CollectPass, ...]
    use: Use


def _aircraft(range_m: float) -> Aircraft:
    return Aircraft(
        "a", "fixed_wing", "ardupilot", airspeed_m_s=20.0, min_turn_radius_m=50.0, max_range_m=range_m
    )


def _trip_m(places: list[Point]) -> float:
    return sum(math.dist(a, b) for a, b in itertools.pairwise([HOME, *places, HOME]))


def _fly(places: dict[str, Point]) -> Callable[[frozenset[str]], Toy]:
    def fly(left: frozenset[str]) -> Toy:
        names = [name for name in places if name not in left]
        best = min(itertools.permutations(names), key=lambda order: _trip_m([places[n] for n in order]))
        passes = tuple(
            CollectPass(
                (name,), "s", "down", places[name], (places[name][0] + 1e-6, places[name][1]), 0.0, Polygon()
            )
            for name in best
        )
        length_m = _trip_m([places[name] for name in best]) + LIFT_M
        return Toy(passes, Use(length_m, length_m / 20.0, None))

    return fly


def _offer(places: dict[str, Point], optional: dict[str, float]) -> Offer:
    points = np.array([HOME, *places.values(), HOME])
    costs = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))[:, :, None, None]
    dear = sum(optional.values()) + 1.0
    rewards = [0.0, *(optional.get(name, dear) for name in places), 0.0]
    return Offer(tuple((name,) for name in places), Choices(costs, np.array(rewards), math.inf), optional, 0)


def _case(seed: int) -> tuple[dict[str, Point], dict[str, float], float]:
    generator = np.random.default_rng(seed)
    places = {f"P{k}": (float(x), float(y)) for k, (x, y) in enumerate(generator.uniform(-2e3, 2e3, (6, 2)))}
    optional = {name: float(generator.integers(1, 10)) for name in list(places)[1:]}
    whole_m = _fly(places)(frozenset()).use.length_m
    return places, optional, float(generator.uniform(0.5, 0.9)) * whole_m


def test_never_less_priority_than_greedily() -> None:
    """Over random places the offer loses nowhere, wins somewhere, and is mostly the best there is."""
    won, best_of_all = 0, 0
    for seed in range(30):
        places, optional, range_m = _case(seed)
        fly, aircraft = _fly(places), _aircraft(range_m)
        earnest: list[frozenset[str]] = []

        def in_earnest(names: frozenset[str], f: Any = fly, told: Any = earnest) -> Toy:
            told.append(names)
            return cast(Toy, f(names))

        def in_haste(names: frozenset[str], f: Any = fly) -> Toy:
            flown = f(names)
            longer_m = HASTE * flown.use.length_m
            return Toy(flown.passes, Use(longer_m, longer_m / 20.0, None))

        arguments = (fly(frozenset()), in_earnest, in_haste, optional, aircraft, (HOME, HOME))
        plain, dropped = within_limits(*arguments)
        if strain(aircraft, plain.use) > 1.0:
            # What is required is too far by itself: nothing to choose.
            continue
        flight, left = within_limits(*arguments, lambda p=places, o=optional: _offer(p, o))
        # Those in earnest are of what is chosen, of longer routes, and of what lies near.
        assert len(earnest) <= 2 * (1 + TRIED_AGAIN) + IN_EARNEST
        lost = sum(optional[each.name] for each in left)
        assert flight.use.length_m <= range_m
        assert lost <= sum(optional[each.name] for each in dropped)
        assert all(each.excess.constraint == "range" and each.excess.margin > 0.0 for each in left)
        won += lost < sum(optional[each.name] for each in dropped)
        least = min(
            sum(optional[name] for name in names)
            for size in range(len(optional) + 1)
            for names in itertools.combinations(optional, size)
            if fly(frozenset(names)).use.length_m <= range_m
        )
        best_of_all += lost == pytest.approx(least)
    assert won >= 1
    assert best_of_all >= 20


def test_what_is_required_is_kept() -> None:
    """A length that does not do for what is required offers nothing; one that does keeps it."""
    places = {"FAR": (1000.0, 0.0), "NEAR": (0.0, 100.0)}
    offer = _offer(places, {"NEAR": 5.0})
    assert offer.kept(1900.0) is None
    kept = offer.kept(2000.0)
    assert kept is not None
    assert (kept.left, kept.length_m, kept.proved) == (frozenset({"NEAR"}), pytest.approx(2000.0), True)
    assert offer.whole_m() == pytest.approx(100.0 + math.hypot(1000.0, 100.0) + 1000.0)
