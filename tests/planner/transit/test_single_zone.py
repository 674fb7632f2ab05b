"""Round one zone: as short as a fine grid of ways round it says, with directions at both ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from planner.airspace.zones import Disc, KeepOut
from planner.dubins.path import Path
from planner.dubins.words import candidates
from planner.route import Anchor, Pose
from planner.transit.tangent import connect

RADIUS_M = 100.0


def apart_m(path: Path) -> float:
    """How near a line comes to the origin, by its segments' own geometry."""
    least = math.inf
    for segment in path.segments:
        ends = [math.hypot(*segment.start.position), math.hypot(*segment.end.position)]
        least = min(least, *ends)
        if segment.centre is None:
            along = math.cos(segment.start.angle_rad), math.sin(segment.start.angle_rad)
            part = -(segment.start.east_m * along[0] + segment.start.north_m * along[1])
            if 0.0 < part < segment.length_m:
                least = min(least, math.hypot(*segment.at(part).position))
            continue
        # The nearest place of the whole circle lies towards the origin; does the arc reach it?
        east_m, north_m = segment.centre
        begun = math.atan2(segment.start.north_m - north_m, segment.start.east_m - east_m)
        wanted = math.atan2(-north_m, -east_m)
        side = 1.0 if segment.kind == "left" else -1.0
        if (side * (wanted - begun)) % math.tau * segment.radius_m <= segment.length_m:
            least = min(least, abs(math.hypot(east_m, north_m) - segment.radius_m))
    return least


def clear_m(start: Pose, goal: Pose, disc_m: float) -> float:
    """Length of the shortest Dubins word that keeps out of the disc; inf without any."""
    words = candidates(start, goal, RADIUS_M)
    return next((word.length_m for word in words if apart_m(word) >= disc_m - 1e-6), math.inf)


def on_disc(angle_rad: float, side: float, disc_m: float) -> Pose:
    """The pose on the disc's circle at an angle, along the circle: counter-clockwise where side is 1."""
    place = disc_m * math.cos(angle_rad), disc_m * math.sin(angle_rad)
    return Pose(*place, angle_rad + side * math.pi / 2.0)


def reference_m(start: Pose, goal: Pose, disc_m: float, count: int) -> float:
    """The shortest of: a clear word; a clear word to the circle, along it, and a clear word from it.

    Places on the circle are a grid, finer round the best.
    """
    best_m = clear_m(start, goal, disc_m)
    for side in (1.0, -1.0):
        ins = outs = np.arange(count) * math.tau / count
        step = math.tau / count
        for _ in range(4):
            to_m = np.array([clear_m(start, on_disc(a, side, disc_m), disc_m) for a in ins.tolist()])
            from_m = np.array([clear_m(on_disc(a, side, disc_m), goal, disc_m) for a in outs.tolist()])
            along_m = disc_m * np.mod(side * (outs[None, :] - ins[:, None]), math.tau)
            # A touch: no way round the whole circle for the last digit's sake.
            along_m[along_m > disc_m * (math.tau - 1e-9)] = 0.0
            whole_m = to_m[:, None] + along_m + from_m[None, :]
            into, out = np.unravel_index(int(np.argmin(whole_m)), whole_m.shape)
            best_m = min(best_m, float(whole_m[into, out]))
            near = np.arange(-8, 9) / 8.0 * step
            ins, outs, step = ins[into] + near, outs[out] + near, step / 8.0
    return best_m


def ends(seed: int) -> tuple[Pose, Pose, float]:
    """Two poses on either side of a disc about the origin, in any direction, with room to turn."""
    rng = np.random.default_rng(seed)
    disc_m = float(rng.uniform(RADIUS_M, 600.0))
    bearing = rng.uniform(-math.pi, math.pi)
    poses = []
    for turned in (bearing, bearing + rng.uniform(0.6, 1.4) * math.pi):
        away_m = disc_m + rng.uniform(250.0, 1500.0)
        place = away_m * math.cos(turned), away_m * math.sin(turned)
        poses.append(Pose(*place, float(rng.uniform(-math.pi, math.pi))))
    return poses[0], poses[1], disc_m


@pytest.mark.parametrize("seed", range(16))
def test_as_short_as_the_fine_grid_says(seed: int) -> None:
    """From pose to pose round one disc the length is the reference's, to a decimetre."""
    start, goal, disc_m = ends(seed)
    zones = KeepOut((Disc("d", 0.0, 0.0, disc_m, True),))
    path = connect(
        Anchor(*start.position, start.angle_rad), Anchor(*goal.position, goal.angle_rad), zones, RADIUS_M
    )
    assert apart_m(path) >= disc_m - 2e-3
    assert path.length_m == pytest.approx(reference_m(start, goal, disc_m, 120), abs=0.1)
