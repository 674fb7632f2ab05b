"""All the ways to see a region, and the refusals."""

import math

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, MultiPolygon, Polygon

from planner.coverage.strips.neighbourhood import can_be_seen, neighbourhoods, options
from planner.errors import InfeasibleError
from planner.sensors.sar import SarSensor
from planner.wishes import Region
from tests.planner.coverage.shapes import HEIGHT_M, as_merged, box, paper_sensor, polygons, sample, unseen_m2

SENSOR = paper_sensor()
POINT, QUASI, DISTRIBUTED = box(300.0, 300.0), box(1200.0, 400.0, 0.5), box(850.0, 750.0, 0.3)


def refusal(
    region: Region, area: Polygon | None, sensor: SarSensor = SENSOR, height_m: float = HEIGHT_M
) -> str:
    """The constraint that forbids a region."""
    with pytest.raises(InfeasibleError) as caught:
        can_be_seen(region, sensor, height_m, area)
    assert caught.value.feature == region.name
    assert caught.value.relaxation
    return caught.value.constraint


@pytest.mark.parametrize(
    ("area", "turns", "angles"), [(POINT, 0, 360), (QUASI, 0, 34), (DISTRIBUTED, 1, 360)]
)
def test_feasible_angles(area: Polygon, turns: int, angles: int) -> None:
    """Point and distributed regions open to all directions, a long strip to those along it."""
    (side,) = neighbourhoods(as_merged(area), SENSOR, HEIGHT_M)
    assert side.turns == turns
    assert len(side.angles_rad) == pytest.approx(angles, abs=2)


@settings(max_examples=20, deadline=None)
@given(polygons((60.0, 560.0)))
def test_options_see_the_region_from_inside_the_area(area: Polygon) -> None:
    """Every option covers the region, flies inside the area, and no single pass is among pairs."""
    around = area.centroid.buffer(1500.0)
    found = list(
        options(as_merged(area), paper_sensor("left", "right"), HEIGHT_M, (0.0, 0.3, 0.7), 0.2, around)
    )
    assert found
    assert len({len(passes) for passes in found}) == 1
    for passes in found:
        assert unseen_m2(area, (collect.footprint for collect in passes)) < 1e-6 * area.area
        assert all(around.covers(LineString([collect.start, collect.end])) for collect in passes)
        assert sum(collect.eta for collect in passes) <= 1.0 + 1e-9


def test_pairs_of_offsets() -> None:
    """Of a distributed region all pairs with η₁ + η₂ ≤ 1 are options, and no others."""
    found = list(options(as_merged(DISTRIBUTED), SENSOR, HEIGHT_M, (0.0, 0.5, 1.0), math.pi / 2.0))
    assert len(found) == 4 * 6
    assert {tuple(p.eta for p in passes) for passes in found} == {
        (0.0, 0.0), (0.0, 0.5), (0.0, 1.0), (0.5, 0.0), (0.5, 0.5), (1.0, 0.0),
    }  # fmt: skip


def test_limited_directions() -> None:
    """Only allowed directions are flown; a strip to be flown across gets two passes, both ways allowed."""
    along, across = 0.5, 0.5 + math.pi / 2.0
    strip = box(1100.0, 400.0, 0.5)
    (side,) = neighbourhoods(as_merged(strip, (along,)), SENSOR, HEIGHT_M)
    assert (side.turns, side.angles_rad.tolist()) == (0, [pytest.approx(along)])
    (side,) = neighbourhoods(as_merged(strip, (across, across - math.pi)), SENSOR, HEIGHT_M)
    assert side.turns == 1
    assert len(side.angles_rad) == 2
    with pytest.raises(InfeasibleError) as caught:
        neighbourhoods(as_merged(strip, (across,)), SENSOR, HEIGHT_M)
    assert caught.value.constraint == "approach"


def test_wider_than_two_swaths() -> None:
    """The refusal names the height from which two swaths would do, and from there they do."""
    region = Region("big", box(1500.0, 1400.0))
    assert refusal(region, None) == "swath"
    needed_m = HEIGHT_M * 1400.0 / (2.0 * SENSOR.swath_m(HEIGHT_M))
    with pytest.raises(InfeasibleError, match=f"fly at {needed_m:.0f} m or higher"):
        can_be_seen(region, SENSOR, HEIGHT_M, None)
    can_be_seen(region, SENSOR, needed_m + 1.0, None)


@pytest.mark.parametrize("case", [1, 2, 3, 4])
def test_sample_scenarios_can_be_seen(case: int) -> None:
    """Every region of the paper's cases is seen from inside the map."""
    scenario = sample(case)
    for region in scenario.regions:
        can_be_seen(region, SENSOR, scenario.height_m, scenario.area)


def test_no_line_inside_the_area() -> None:
    """A region that fills its operating area cannot be seen from beside it; with 300 m more it can."""
    region = Region("R", POINT)
    assert refusal(region, POINT.buffer(200.0)) == "area"
    can_be_seen(region, SENSOR, HEIGHT_M, POINT.buffer(500.0))


def test_area_on_one_side_only() -> None:
    """With the area on one side of a strip, a right-looking sensor passes it one way only."""
    strip, north = box(1200.0, 400.0), shapely.box(0.0, -1700.0, 2000.0, -1000.0)
    found = list(options(as_merged(strip), SENSOR, HEIGHT_M, area=north))
    assert found
    assert all(abs(passes[0].angle_rad) < 0.5 for passes in found)
    found = list(options(as_merged(strip), paper_sensor("left"), HEIGHT_M, area=north))
    assert all(abs(abs(passes[0].angle_rad) - math.pi) < 0.5 for passes in found)


def test_each_part_counts() -> None:
    """A region of two parts is refused where one of them cannot be seen."""
    far = shapely.affinity.translate(POINT, 5000.0, 0.0)
    area = POINT.buffer(800.0)
    can_be_seen(Region("R", POINT), SENSOR, HEIGHT_M, area)
    assert refusal(Region("R", MultiPolygon([POINT, far])), area) == "area"


def test_resolution_and_beam() -> None:
    """Too coarse a sensor, one of unknown resolution, and beams not on one side of the track are refused."""
    sharp = Region("R", POINT, min_resolution_m=0.5)
    fine = SarSensor("fine", 0.8, 0.5, 0.1, resolution_m=0.5)
    can_be_seen(sharp, fine, HEIGHT_M, None)
    assert refusal(sharp, None, SarSensor("coarse", 0.8, 0.5, 0.1, resolution_m=1.0)) == "resolution"
    assert refusal(sharp, None, SENSOR) == "resolution"
    for wish in ({"min_resolution_m": 0.5}, {"min_resolution_m": 0.5, "gsd_m": 0.5}):
        # What the operator has written is what may be relaxed.
        with pytest.raises(InfeasibleError) as caught:
            can_be_seen(Region("R", POINT, **wish), SENSOR, HEIGHT_M, None)
        assert caught.value.relaxation.endswith(f"or relax {list(wish)[-1]}")
    for beam in ((0.1, 0.5), (1.5, 0.5), (0.8, 0.0)):
        assert refusal(Region("R", POINT), None, SarSensor("odd", *beam, 0.1)) == "swath"
    assert refusal(Region("R", POINT), None, fine, 0.0) == "swath"


@settings(max_examples=30, deadline=None)
@given(polygons((60.0, 560.0)), st.floats(100.0, 1500.0), st.floats(-1000.0, 1000.0))
def test_can_be_seen_agrees_with_options(area: Polygon, reach_m: float, shift_m: float) -> None:
    """What has an option can be seen; what is further away than the near range cannot."""
    around = shapely.affinity.translate(area.centroid.buffer(reach_m), shift_m, 0.0)
    has_option = any(True for _ in options(as_merged(area), SENSOR, HEIGHT_M, (0.0, 0.5, 1.0), area=around))
    if has_option:
        can_be_seen(Region("R", area), SENSOR, HEIGHT_M, around)
    elif not around.intersects(area.buffer(SENSOR.near_m(HEIGHT_M))):
        assert refusal(Region("R", area), around) == "area"
