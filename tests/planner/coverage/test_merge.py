"""The close filter on outlines against the paper's on pixels, and who may merge with whom."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import MultiPolygon, Polygon
from skimage.measure import label
from skimage.morphology import closing, disk

from planner.coverage.merge import close_filter, merge_regions, polygons_of, split_region
from planner.wishes import Region
from tests.planner.coverage.shapes import box, polygons, sample, unseen_m2

PIXEL_M = 5.4


def raster_close(area: MultiPolygon, radius_px: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The paper's stage on a binary image: pixel centres, and labels of the closed image."""
    west, south, east, north = area.buffer(3 * radius_px * PIXEL_M).bounds
    easts, norths = np.meshgrid(np.arange(west, east, PIXEL_M), np.arange(south, north, PIXEL_M))
    image = shapely.contains_xy(area, easts, norths)
    return easts, norths, label(closing(image, disk(radius_px)), connectivity=2)


def squares(*places: tuple[float, float], side_m: float = 200.0) -> tuple[Region, ...]:
    """Square regions with their south-west corners at these places."""
    return tuple(
        Region(f"S{k}", shapely.box(east, north, east + side_m, north + side_m))
        for k, (east, north) in enumerate(places)
    )


@pytest.mark.parametrize(
    ("gap_m", "components"), [(20.0, 1), (60.0, 1), (120.0, 1), (158.0, 1), (175.0, 2), (400.0, 2)]
)
def test_components_as_on_pixels(gap_m: float, components: int) -> None:
    """Facing squares merge up to a gap of one disk, 162 m, on outlines as on the paper's pixels."""
    regions = squares((0.0, 0.0), (200.0 + gap_m, 0.0))
    whole = MultiPolygon([p for region in regions for p in polygons_of(region.area)])
    *_, labels = raster_close(whole, 15)
    assert len(merge_regions(regions)) == components == labels.max()


@settings(max_examples=12, deadline=None)
@given(polygons((80.0, 250.0)), polygons((80.0, 250.0)), st.floats(0.0, 6.28), st.floats(1.1, 2.2))
def test_closed_shape_as_on_pixels(one: Polygon, other: Polygon, bearing: float, apart: float) -> None:
    """The closed shapes agree but for the pixels along their outlines."""
    reach_m = apart * 250.0
    other = affinity.translate(
        other,
        one.centroid.x + reach_m * math.cos(bearing) - other.centroid.x,
        one.centroid.y + reach_m * math.sin(bearing) - other.centroid.y,
    )
    whole = shapely.union_all([one, other])
    easts, norths, labels = raster_close(whole, 8)
    closed = close_filter(whole, 8 * PIXEL_M)
    differs = shapely.contains_xy(closed, easts, norths) != (labels > 0)
    # A pixel disk is up to one pixel off the true one, and so is each of the two steps.
    near_outline = shapely.dwithin(
        closed.boundary, shapely.points(easts[differs], norths[differs]), 4 * PIXEL_M
    )
    thin_bridges = np.count_nonzero(~near_outline)
    assert thin_bridges == 0


@settings(max_examples=60, deadline=None)
@given(st.lists(polygons((50.0, 300.0)), min_size=1, max_size=4), st.floats(0.0, 200.0))
def test_nothing_is_lost(areas: list[Polygon], radius_m: float) -> None:
    """Closing holds what it closes, does nothing when done again, and stays in the convex hull of all."""
    whole = shapely.union_all(areas)
    closed = close_filter(whole, radius_m)
    assert unseen_m2(whole, [closed]) <= 1e-8 * whole.area
    assert unseen_m2(closed, [whole.convex_hull.buffer(1e-5)]) <= 1e-8 * whole.area
    again = close_filter(closed, radius_m)
    # The disk has 64 corners: its radius is right to 0.12 %.
    assert again.area <= (1.0 + 1e-9) * closed.area + 0.0025 * radius_m * closed.length


@settings(max_examples=60, deadline=None)
@given(polygons(), st.floats(0.0, 200.0))
def test_lone_region_keeps_its_hull(area: Polygon, radius_m: float) -> None:
    """Merging changes no span of a region without neighbours."""
    (merged,) = merge_regions((Region("A", area),), radius_m)
    assert merged.names == ("A",)
    assert merged.originals == (area,)
    assert merged.area.convex_hull.hausdorff_distance(area.convex_hull) < 1e-6


def test_names_originals_and_split() -> None:
    """A merged region knows whose parts it holds and gives them back one by one."""
    merged = merge_regions(squares((0.0, 0.0), (2000.0, 0.0), (250.0, 0.0)))
    assert [region.names for region in merged] == [("S0", "S2"), ("S1",)]
    assert merged[0].label == "S0+S2"
    assert merged[0].area.area == pytest.approx(450.0 * 200.0, rel=1e-2)
    assert [(part.names, part.area.area) for part in merged[0].split()] == [
        (("S0",), pytest.approx(40000.0)),
        (("S2",), pytest.approx(40000.0)),
    ]


def test_far_parts_of_one_region_stay_apart() -> None:
    """A MultiPolygon whose parts the filter does not bridge becomes several under one name."""
    far = MultiPolygon([box(200.0, 200.0), affinity.translate(box(200.0, 200.0), 900.0, 0.0)])
    near = MultiPolygon([box(200.0, 200.0), affinity.translate(box(200.0, 200.0), 260.0, 0.0)])
    assert [region.names for region in merge_regions((Region("A", far),))] == [("A",), ("A",)]
    (whole,) = merge_regions((Region("A", near),))
    assert whole.names == ("A",)
    assert len(whole.originals) == 2
    assert len(split_region(Region("A", far))) == 2


def test_only_alike_regions_merge() -> None:
    """Neighbours with other sensors, other approach directions or another duty stay apart."""
    one, other = squares((0.0, 0.0), (220.0, 0.0))
    alike = {"sensor": "sar", "approach_rad": (0.0, math.pi)}
    same = (
        Region("A", one.area, sensor=None, approach_rad=(2.0 * math.pi, math.pi)),
        Region("B", other.area, **alike),
    )
    assert len(merge_regions(same, default_sensor="sar")) == 1
    for change in ({"sensor": "wide"}, {"approach_rad": (0.0,)}, {"approach_rad": None}, {"required": False}):
        regions = (Region("A", one.area, **alike), Region("B", other.area, **{**alike, **change}))
        assert [region.names for region in merge_regions(regions)] == [("A",), ("B",)]


def test_touching_regions_merge_without_a_filter() -> None:
    """Radius 0 still joins what touches and nothing else."""
    merged = merge_regions(squares((0.0, 0.0), (200.0, 0.0), (401.0, 0.0)), 0.0)
    assert [region.names for region in merged] == [("S0", "S1"), ("S2",)]


def test_paper_regions_stay_six() -> None:
    """The sample scenarios hold the paper's regions after merging: six, far apart."""
    assert [region.names for region in merge_regions(sample(1).regions)] == [
        (name,) for name in ("R1", "R2", "R3", "R4", "R5", "R6")
    ]


def test_region_given_twice_with_other_last_digits() -> None:
    """The same ground drawn twice, apart by 1e-13 m, is one region of that area."""
    twice = (
        Polygon([(298.973784427414, 202.57657150448352), (-235.09749215211428, 202.57657150448364),
                 (-235.09749215211437, -374.7736976851418), (298.97378442741393, -374.77369768514194)]),
        Polygon([(298.97378442741405, 202.57657150448352), (-235.09749215211428, 202.57657150448364),
                 (-235.0974921521144, -374.7736976851418), (298.97378442741393, -374.77369768514194)]),
    )  # fmt: skip
    for radius_m in (0.0, 81.0):
        (merged,) = merge_regions((Region("A", twice[0]), Region("B", twice[1])), radius_m)
        assert merged.names == ("A", "B")
        assert merged.area.area == pytest.approx(twice[0].area)
