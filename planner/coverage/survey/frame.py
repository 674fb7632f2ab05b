"""What laying lanes needs to know of a camera's photos, at headings and from a height."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.sensors.camera import CameraSensor

Floats = NDArray[np.float64]

#: A length that a height and a heading give.
Figure = Callable[[float, float], float]


@dataclass(frozen=True, slots=True)
class Frames:
    """A camera's figures at headings, (M,) each, metres.

    Parameters
    ----------
    spacing_m
        Between lanes at most; not more than 0 where no lanes keep the overlap.
    twice_m
        How far from the outermost lane a place is still seen from the next one, too.
    photos_m
        Between photos at most.
    """

    spacing_m: Floats
    twice_m: Floats
    photos_m: Floats

    @property
    def good(self) -> NDArray[np.bool_]:
        """At which headings lanes keep the overlaps."""
        return np.asarray((self.spacing_m > 0.0) & (self.photos_m > 0.0), dtype=np.bool_)


def frames(camera: CameraSensor, height_m: float, angles_rad: Floats) -> Frames:
    """The figures for lanes flown to and fro: the lesser of both ways."""

    def lesser(figure: Figure) -> Floats:
        ways = (angles_rad, angles_rad + math.pi)
        return np.minimum(*(_each(camera, figure, height_m, way_rad) for way_rad in ways))

    spacing_m, half_m = lesser(camera.lane_spacing_m), lesser(camera.half_width_m)
    return Frames(spacing_m, half_m - spacing_m, lesser(camera.photo_spacing_m))


def runs_m(camera: CameraSensor, height_m: float, angles_rad: Floats) -> tuple[Floats, Floats]:
    """Run-in and run-out of lanes flown at headings (M,)."""
    run_in_m = _each(camera, camera.run_in_m, height_m, angles_rad)
    return run_in_m, _each(camera, camera.run_out_m, height_m, angles_rad)


def _each(camera: CameraSensor, figure: Figure, height_m: float, angles_rad: Floats) -> Floats:
    if not camera.crabs:
        return np.full(len(angles_rad), figure(height_m, 0.0))
    return np.array([figure(height_m, angle_rad) for angle_rad in angles_rad.tolist()], dtype=np.float64)
