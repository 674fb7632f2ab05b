"""Ground really seen: kernels against a plain twin, edges, shadow and layover against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.sensors.sar import SarSensor
from planner.sensors.view import seen_on_flat, seen_on_terrain, shadow_cost, spread
from planner.sensors.view_kernels import LAYOVER, OUT, SEEN, SHADOW, profile_flags
from tests.planner.terrains import grid

SENSOR = SarSensor("sar", math.radians(45.0), math.radians(30.0), math.radians(10.0))
LEVEL_M = 500.0
NEAR_TAN, FAR_TAN = math.tan(math.radians(30.0)), math.tan(math.radians(60.0))
#: Eastward, looking right: to the south.
LINE = ((-500.0, 900.0), (700.0, 900.0))


def plain_flags(level_m, out_m, ground_m, near_tan, far_tan):
    """The definition, place against place: what hides it, what has its range."""
    places = [j for j in range(len(out_m)) if not math.isnan(ground_m[j])]
    tangent = {j: out_m[j] / (level_m - ground_m[j]) if ground_m[j] < level_m else math.inf for j in places}
    flags = [OUT] * len(out_m)
    lit = []
    for j in places:
        if near_tan <= tangent[j] <= far_tan:
            hidden = any(tangent[k] >= tangent[j] for k in places if k < j)
            flags[j] = SHADOW if hidden else SEEN
            if not hidden:
                lit.append(j)
    slant = {j: math.hypot(out_m[j], level_m - ground_m[j]) for j in lit}
    for j in lit:
        if any((slant[k] >= slant[j]) if k < j else (slant[k] <= slant[j]) for k in lit if k != j):
            flags[j] = LAYOVER
    return flags


@settings(max_examples=200)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 300.0))
def test_profile_flags_are_those_of_the_plain_twin(seed: int, rough_m: float) -> None:
    """Random rough ground with gaps gets the same flags from the kernel and from the definition."""
    rng = np.random.default_rng(seed)
    out_m = 10.0 * np.arange(1, 101)
    ground_m = np.cumsum(rng.normal(0.0, rough_m / 10.0, 100))
    ground_m[rng.random(100) < 0.05] = np.nan
    found = profile_flags(LEVEL_M, out_m, ground_m, NEAR_TAN, FAR_TAN, 1.0)
    assert found.tolist() == plain_flags(LEVEL_M, out_m, ground_m, NEAR_TAN, FAR_TAN)


def test_flat_terrain_is_seen_as_flat_ground() -> None:
    """On a level raster the mask is the closed-form rectangle, to a millimetre of its edges."""
    ground = grid(lambda e, n: 120.0 + 0.0 * e, step_m=30.0)
    seen = seen_on_terrain(SENSOR, LINE, "right", LEVEL_M + 120.0, ground)
    flat = seen_on_flat(SENSOR, LINE, "right", LEVEL_M)
    assert seen.area.symmetric_difference(flat).area < 1e-3
    assert (seen.shadow_m2, seen.layover_m2) == (0.0, 0.0)


@pytest.mark.parametrize("slope", [0.25, -0.25])
@pytest.mark.parametrize("look", ["left", "right"])
def test_edges_on_a_ramp(slope: float, look: str) -> None:
    """On a plane rising or falling away from the track the edges are where the beam's lines meet it."""
    away = 1.0 if look == "left" else -1.0
    ground = grid(lambda e, n: slope * away * n, step_m=20.0)
    line = ((-600.0, 0.0), (600.0, 0.0))
    seen = seen_on_terrain(SENSOR, line, look, LEVEL_M, ground)
    reach = np.abs(shapely.get_coordinates(seen.area)[:, 1])
    # y = (H − slope·y)·tan θ
    assert reach.min() == pytest.approx(LEVEL_M * NEAR_TAN / (1.0 + slope * NEAR_TAN), abs=0.02)
    assert reach.max() == pytest.approx(LEVEL_M * FAR_TAN / (1.0 + slope * FAR_TAN), abs=0.02)
    assert (seen.shadow_m2, seen.layover_m2) == (0.0, 0.0)


def test_a_slope_steeper_than_the_look_is_in_layover() -> None:
    """Facing slopes steeper than the look angle's complement to the ray are laid over, gentler are not."""
    for slope, some in ((math.tan(math.radians(50.0)), True), (math.tan(math.radians(20.0)), False)):
        ground = grid(lambda e, n, s=slope: np.clip((-n - 450.0) * s, 0.0, 60.0), step_m=10.0)
        seen = seen_on_terrain(SENSOR, ((-600.0, 0.0), (600.0, 0.0)), "right", LEVEL_M, ground)
        assert (seen.layover_m2 > 0.0) == some


def test_a_wall_throws_the_shadow_of_its_height() -> None:
    """Behind a wall of height w at distance y the shadow reaches to y·H / (H − w)."""
    w_m, y_m, step_m = 80.0, 400.0, 5.0
    ground = grid(
        lambda e, n: np.where(np.abs(-n - y_m) < step_m / 2, w_m, 0.0), half_m=1500.0, step_m=step_m
    )
    line = ((-600.0, 0.0), (600.0, 0.0))
    seen = seen_on_terrain(SENSOR, line, "right", LEVEL_M, ground)
    ray = shapely.LineString([(0.0, -300.0), (0.0, -800.0)])
    gaps = ray.difference(seen.area.buffer(1e-6))
    shadow = max(shapely.get_parts(gaps), key=lambda part: part.length)
    assert -shadow.bounds[1] == pytest.approx(y_m * LEVEL_M / (LEVEL_M - w_m), abs=2.0 * step_m)
    assert seen.shadow_m2 > 0.0


def test_a_cone_hides_ground_behind_it_alone() -> None:
    """A steep cone leaves a hole behind itself: seen from the other side, the hole lies on the other side."""
    cone = lambda e, n: np.clip(200.0 - np.hypot(e - 100.0, n - 350.0) * 1.6, 0.0, None)  # noqa: E731
    ground = grid(cone, step_m=10.0, half_m=2000.0)
    behind, before = shapely.Point(100.0, 130.0).buffer(10.0), shapely.Point(100.0, 570.0).buffer(10.0)
    south = seen_on_terrain(SENSOR, LINE, "right", LEVEL_M, ground).area
    assert not south.intersects(behind)
    back = ((700.0, -200.0), (-500.0, -200.0))
    north = seen_on_terrain(SENSOR, back, "right", LEVEL_M, ground).area
    assert north.covers(behind)
    assert not north.intersects(before)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_ground_seen_is_never_hidden(seed: int) -> None:
    """From every place in the seen area the straight line to the aircraft is clear of the ground."""
    rng = np.random.default_rng(seed)
    bumps = rng.uniform((-600, -200, 80, 40), (800, 900, 250, 200), (6, 4))

    def hills(e, n):
        return sum(h * np.exp(-((e - x) ** 2 + (n - y) ** 2) / (2 * s**2)) for x, y, s, h in bumps)

    ground = grid(hills, step_m=20.0, half_m=2000.0)
    area = seen_on_terrain(SENSOR, LINE, "right", LEVEL_M, ground).area
    if area.is_empty:
        return
    places = spread(area.buffer(-15.0), 60)
    for east_m, north_m in places[shapely.contains_xy(area.buffer(-14.0), places)]:
        share = np.linspace(0.0, 0.97, 60)
        ray = np.stack([np.full(60, east_m), 900.0 + share * (north_m - 900.0)], axis=1)
        z_m = float(ground.at((east_m, north_m)))
        assert (LEVEL_M + share * (z_m - LEVEL_M) >= ground.at(ray) - 1.0).all()


def test_shadow_cost_prefers_the_clear_side() -> None:
    """The line from which a ridge hides the region costs; that from the other side does not."""
    ground = grid(lambda e, n: 150.0 * np.exp(-(((n - 300.0) / 40.0) ** 2)), half_m=2000.0, step_m=10.0)
    region = shapely.box(-100.0, 20.0, 100.0, 150.0)
    lines = np.array([[(-400.0, 700.0), (400.0, 700.0)], [(400.0, -400.0), (-400.0, -400.0)]])
    cost_m = shadow_cost(lines, "right", SENSOR, LEVEL_M, region, ground)
    assert cost_m[0] > 0.0
    assert cost_m[1] == 0.0


def test_unknown_ground_is_not_seen() -> None:
    """A gap in the raster is a gap in the view."""
    ground = grid(lambda e, n: np.where((np.abs(e) < 50) & (np.abs(n - 300) < 50), np.nan, 0.0), step_m=10.0)
    seen = seen_on_terrain(SENSOR, LINE, "right", LEVEL_M, ground).area
    assert not seen.intersects(shapely.Point(0.0, 300.0))
    assert seen.contains(shapely.Point(200.0, 300.0))
    nothing = replace(ground, heights_m=np.full_like(ground.heights_m, np.nan))
    assert seen_on_terrain(SENSOR, LINE, "right", LEVEL_M, nothing).area.is_empty


@pytest.mark.parametrize("squint_deg", [-20.0, 15.0])
def test_squinted_views_shift_along_the_track(squint_deg: float) -> None:
    """A squinted pass sees, at slant range R, ground R·tan ahead; on a level raster as on flat ground."""
    squinted = replace(SENSOR, squint_rad=math.radians(squint_deg))
    flat = seen_on_flat(squinted, ((0.0, 0.0), (1500.0, 0.0)), "right", LEVEL_M)
    coordinates = shapely.get_coordinates(flat)
    far = coordinates[np.argmin(coordinates[:, 1])]
    half_m = squinted.aperture_m(LEVEL_M) / 2.0
    lead_m = math.hypot(far[1], LEVEL_M) * math.tan(squinted.squint_rad)
    ends = {half_m + lead_m, 1500.0 - half_m + lead_m}
    assert min(abs(far[0] - end) for end in ends) < 1e-6
    ground = grid(lambda e, n: 0.0 * e, step_m=30.0)
    seen = seen_on_terrain(squinted, ((0.0, 0.0), (1500.0, 0.0)), "right", LEVEL_M, ground).area
    # The curved ends are drawn with other points, chords of one hyperbola.
    assert seen.symmetric_difference(flat).area < 2e-4 * flat.area


def test_relief_keeps_every_height_in_the_beam() -> None:
    """The swath over relief is what the beam holds of the lowest and of the highest ground alike."""
    rough = SENSOR.over_relief(40.0)
    for height_m in (LEVEL_M - 40.0, LEVEL_M + 40.0):
        assert SENSOR.near_m(height_m) <= rough.near_m(LEVEL_M) + 1e-9
        assert SENSOR.far_m(height_m) >= rough.far_m(LEVEL_M) - 1e-9
        assert SENSOR.aperture_m(height_m) <= rough.aperture_m(LEVEL_M) + 1e-9
