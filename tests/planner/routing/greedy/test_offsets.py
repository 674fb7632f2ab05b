"""Offsets of eq 22."""

import math

import numpy as np
import pytest
import shapely

from planner.airspace.threats import line_risk
from planner.airspace.values import Threat
from planner.coverage.strips.choices import Choices, choices
from planner.coverage.strips.room import Room
from planner.route import Anchor, CollectPass
from planner.routing.greedy.offsets import best_passes
from planner.wishes import Objective
from tests.planner.coverage.shapes import HEIGHT_M, as_merged, box, paper_sensor, unseen_m2

OPEN = Room(None, shapely.MultiPolygon(), shapely.MultiPolygon(), 100.0, 0.0)
ORIGIN = Anchor(-2000.0, -1000.0, 0.0)
SINGLE = choices(as_merged(box(300.0, 300.0)), paper_sensor(), HEIGHT_M, OPEN)
DOUBLE = choices(as_merged(box(850.0, 750.0)), paper_sensor(), HEIGHT_M, OPEN)


def cost(
    origin: Anchor, collect: CollectPass, middle: CollectPass, threats: tuple[Threat, ...], w: Objective
) -> float:
    """Eq 22 written out."""
    ratio = math.dist(origin.position, collect.start) / math.dist(origin.position, middle.start)
    missile, radar = line_risk([collect.start, collect.end], threats)
    return w.length * ratio + w.missile * missile + w.radar * radar


@pytest.mark.parametrize("index", [0, 75, 210])
@pytest.mark.parametrize(
    "threats",
    [
        (),
        (Threat("M", "missile", (1000.0, -1400.0), 500.0),),
        (
            Threat("D", "radar", (1300.0, -2500.0), 600.0, 600.0),
            Threat("M", "missile", (500.0, -1900.0), 700.0),
        ),
    ],
)
def test_least_cost_of_the_grid(index: int, threats: tuple[Threat, ...]) -> None:
    """The pass has the least of eq 22 over η in steps of 0.05."""
    objective = Objective(1.0, 2.0, 0.5)
    around = SINGLE.sides[0].neighbourhood
    (found,) = best_passes(ORIGIN, SINGLE, SINGLE.sides[0], index, threats, objective)
    middle = around.collect(index, 0.5)
    every = {
        k / 20: cost(ORIGIN, around.collect(index, k / 20), middle, threats, objective) for k in range(21)
    }
    assert min(abs(found.eta - eta) for eta in every) < 1e-12
    assert cost(ORIGIN, found, middle, threats, objective) == pytest.approx(min(every.values()))


def test_without_threats_the_nearest_line() -> None:
    """The length alone pulls the line towards the origin: out from the north, in from the south."""
    index = 0  # flying east with the region to the right: the lines lie north of it
    (from_north,) = best_passes(Anchor(1000.0, 9000.0), SINGLE, SINGLE.sides[0], index, (), Objective())
    (from_south,) = best_passes(Anchor(1000.0, -9000.0), SINGLE, SINGLE.sides[0], index, (), Objective())
    assert (from_north.eta, from_south.eta) == (1.0, 0.0)


def test_a_missile_pushes_the_line_away() -> None:
    """A missile on the line a free flight would take moves it to another η."""
    (free,) = best_passes(ORIGIN, SINGLE, SINGLE.sides[0], 0, (), Objective())
    centre = ((free.start[0] + free.end[0]) / 2.0, free.start[1])
    missile = Threat("M", "missile", centre, 120.0)
    (wary,) = best_passes(ORIGIN, SINGLE, SINGLE.sides[0], 0, (missile,), Objective())
    assert abs(wary.start[1] - free.start[1]) > 120.0


@pytest.mark.parametrize("index", range(0, 360, 40))
def test_second_pass_is_limited_by_the_first(index: int) -> None:
    """η₂ ≤ 1 − η₁, the second flies back on the other side, and both together see the region."""
    first, second = best_passes(ORIGIN, DOUBLE, DOUBLE.sides[0], index, (), Objective())
    assert first.eta + second.eta <= 1.0 + 1e-9
    assert abs(math.remainder(second.angle_rad - first.angle_rad, 2.0 * math.pi)) == pytest.approx(math.pi)
    area = DOUBLE.region.area
    assert unseen_m2(area, (first.footprint, second.footprint)) < 1e-6 * area.area


def test_first_pass_leaves_room_for_a_second() -> None:
    """Where the second pass is possible only far out, the first stays far enough in."""
    index = 0
    around = DOUBLE.sides[0].neighbourhood
    second = around.lines(DOUBLE.etas, opposite=True)[index]
    # Close every second line with η₂ < 0.5 by a wall just in front of them.
    wall = shapely.MultiPoint(second[:10].reshape(-1, 2)).convex_hull.buffer(1.0)
    walled = choices(
        DOUBLE.region, paper_sensor(), HEIGHT_M, Room(None, wall, shapely.MultiPolygon(), 1.0, 0.0)
    )
    far = Anchor(1000.0, 9000.0)
    free_first, _ = best_passes(far, DOUBLE, DOUBLE.sides[0], index, (), Objective())
    first, last = best_passes(far, walled, walled.sides[0], index, (), Objective())
    assert free_first.eta == 1.0
    assert last.eta >= 0.5
    assert first.eta <= 1.0 - last.eta + 1e-9


def test_only_graded_offsets() -> None:
    """Offsets graded worse than the region's best are not taken, even when nearer."""
    side = SINGLE.sides[0]
    grades = np.full_like(side.grades, 4)
    grades[0, 7] = 0
    graded = Choices(SINGLE.region, 0, SINGLE.etas, (type(side)(side.neighbourhood, grades),), 0)
    (found,) = best_passes(ORIGIN, graded, graded.sides[0], 0, (), Objective())
    assert found.eta == pytest.approx(0.35)
