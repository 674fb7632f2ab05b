"""Passes of one region parted by others: as good as single moves get, never dearer, every pass kept."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point

from planner.errors import CancelledError
from planner.geojson import read_scenario
from planner.progress import never
from planner.route import CollectPass
from planner.routing.joint.split import LEAST_GAIN_M, split_passes
from planner.routing.legs import Legs
from tests.planner.scenarios import small
from tests.planner.stages import legs_of as legs_in

Passes = tuple[CollectPass, ...]

metre = st.floats(-3000.0, 3000.0)
drawn = st.lists(
    st.tuples(metre, metre, st.floats(-3.0, 3.0), st.sampled_from("ABC")), min_size=1, max_size=5
)


def made(rows: Sequence[tuple[float, float, float, str]]) -> Passes:
    """Passes of 300 m from places, in directions, of regions; those of a region side by side."""
    passes = []
    for east_m, north_m, angle_rad, region in sorted(rows, key=lambda row: row[3]):
        end = east_m + 300.0 * math.cos(angle_rad), north_m + 300.0 * math.sin(angle_rad)
        ground = Point(east_m, north_m).buffer(1.0)
        passes.append(CollectPass((region,), "sar", "right", (east_m, north_m), end, 0.0, ground))
    return tuple(passes)


class Straight(Legs):
    """Legs that cost the straight distance, the ways from the start and to the end nothing."""

    def __init__(self) -> None:
        self.asked: list[Passes] = []

    def tour_m(self, passes: Sequence[CollectPass]) -> float:
        """Straight distances from pass to pass."""
        self.asked.append(tuple(passes))
        return straight_m(passes)


def straight_m(passes: Sequence[CollectPass]) -> float:
    """The ways between passes, straight."""
    return sum(math.dist(one.end, other.start) for one, other in itertools.pairwise(passes))


def one_move_away(passes: Passes) -> list[Passes]:
    """Orders that arise when up to three passes in a row, one of several of its region among them, move."""
    found = []
    for order in itertools.permutations(range(len(passes))):
        for first, last in itertools.combinations(range(len(passes) + 1), 2):
            run = list(range(first, last))
            rest = [k for k in range(len(passes)) if k not in run]
            if last - first > 3 or [k for k in order if k not in run] != rest:
                continue
            at = order.index(first)
            if list(order[at : at + len(run)]) != run:
                continue
            shared = [sum(other.regions == passes[k].regions for other in passes) for k in run]
            if max(shared) > 1:
                found.append(tuple(passes[k] for k in order))
    return found


@settings(deadline=None, max_examples=60)
@given(drawn)
def test_no_single_move_is_left_that_saves(rows: list[tuple[float, float, float, str]]) -> None:
    """Where legs cost what the guess says, the result is one that no move makes cheaper by enumeration."""
    passes = made(rows)
    cost_m, found = split_passes(straight_m(passes), passes, Straight(), never)
    assert cost_m == pytest.approx(straight_m(found))
    assert cost_m <= straight_m(passes)
    assert sorted(p.start for p in found) == sorted(p.start for p in passes)
    best_m = min((straight_m(order) for order in one_move_away(found)), default=math.inf)
    assert cost_m <= best_m + LEAST_GAIN_M


@settings(deadline=None, max_examples=40)
@given(drawn)
def test_never_better_than_the_best_order_and_whole_regions_stay(
    rows: list[tuple[float, float, float, str]],
) -> None:
    """Brute force over all orders bounds it from below; without a region of several passes nothing moves."""
    passes = made(rows)
    cost_m, found = split_passes(straight_m(passes), passes, Straight(), never)
    assert cost_m >= min(straight_m(order) for order in itertools.permutations(passes)) - 1e-9
    alone = made([(*row[:3], f"R{k}") for k, row in enumerate(rows)])
    legs = Straight()
    assert split_passes(straight_m(alone), alone, legs, never) == (straight_m(alone), alone)
    assert legs.asked == []
    assert len(found) == len(passes)


def test_two_passes_are_parted_by_what_lies_between() -> None:
    """Out along one pass, the region beyond, back along the other: the best of all, by true legs."""
    scenario = read_scenario(small())
    frame = scenario.frame
    east_m, north_m = frame.north_up(scenario.start.position)
    upright = [
        (east_m + 500.0, north_m + 200.0, 0.0, "A"),
        (east_m + 1500.0, north_m - 200.0, math.pi, "A"),
        (east_m + 4000.0, north_m + 200.0, -math.pi / 2.0, "B"),
    ]
    rows = [
        (*frame.from_north_up([east, north]).tolist(), angle_rad - frame.turned_rad, region)
        for east, north, angle_rad, region in upright
    ]
    passes = made(rows)
    legs = legs_in(scenario, never)
    cost_m, found = split_passes(legs.tour_m(passes), passes, legs, never)
    assert [p.regions[0] for p in found] == ["A", "B", "A"]
    assert cost_m == min(legs.tour_m(order) for order in itertools.permutations(passes))
    assert cost_m < legs.tour_m(passes) - 1000.0


def test_passes_move_together_where_one_alone_does_not_pay() -> None:
    """Two passes far off, flown between regions close to each other, are put last, both at once."""
    rows = [(0.0, 0.0, "A"), (6000.0, 0.0, "B"), (6000.0, 50.0, "B"), (0.0, 50.0, "C"), (5000.0, 0.0, "D")]
    passes = made([(east_m, north_m, 0.0, region) for east_m, north_m, region in rows])
    _, found = split_passes(straight_m(passes), passes, Straight(), never)
    assert [p.regions[0] for p in found] == ["A", "C", "D", "B", "B"]


def test_the_guess_does_not_decide() -> None:
    """A move that straight lines praise and the transits' true costs do not is not made."""

    class Dear(Straight):
        def tour_m(self, passes: Sequence[CollectPass]) -> float:
            """Parted passes cost ten kilometres more than they seem to."""
            regions = [p.regions[0] for p in passes]
            parted = sum(a != b for a, b in itertools.pairwise(regions)) > len(set(regions)) - 1
            return super().tour_m(passes) + 10_000.0 * parted

    passes = made([(500.0, 200.0, 0.0, "A"), (3800.0, -300.0, 3.14, "A"), (4000.0, 200.0, -1.6, "B")])
    assert split_passes(straight_m(passes), passes, Straight(), never)[1] != passes
    _, found = split_passes(straight_m(passes), passes, Dear(), never)
    regions = [p.regions[0] for p in found]
    assert regions in (["A", "A", "B"], ["B", "A", "A"])


def test_stops_when_told() -> None:
    """The stop is asked before each round."""
    with pytest.raises(CancelledError):
        split_passes(0.0, made([(0.0, 0.0, 0.0, "A")]), Straight(), lambda: True)
