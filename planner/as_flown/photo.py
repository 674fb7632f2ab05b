"""A photo as it was taken, and the camera's axes from its attitude."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from planner.plan import PlanCamera

Floats = NDArray[np.float64]

#: Whose attitude a photo tells: of the airframe that the camera is bolted to, or of the camera itself.
AttitudeOf = Literal["airframe", "camera"]


@dataclass(frozen=True, slots=True)
class Photo:
    """One photo that was reported as taken.

    Parameters
    ----------
    lon_deg, lat_deg, height_m
        Where; the height is over the home that the aircraft took off from, NaN where unknown.
    roll_deg, pitch_deg, yaw_deg
        Right wing down, nose up, clockwise from true north; None where not told: then the track's at that
        moment counts.
    index
        Its number in the camera's count; None where not told.
    """

    time_s: float
    lon_deg: float
    lat_deg: float
    height_m: float
    roll_deg: float | None = None
    pitch_deg: float | None = None
    yaw_deg: float | None = None
    attitude_of: AttitudeOf = "airframe"
    index: int | None = None


@dataclass(frozen=True, slots=True)
class Shots:
    """Photos of one camera in the local frame, one row a photo, N of them.

    Parameters
    ----------
    place
        East, north and height over the ground's datum, (N, 3).
    axis, across, upward
        Unit vectors east, north and up: where the camera looks, to the right in the image and up in it,
        (N, 3). Columns of the image run across, rows upward.
    """

    place: Floats
    axis: Floats
    across: Floats
    upward: Floats

    @property
    def rows(self) -> Floats:
        """All of it in one array for the kernels, (N, 12)."""
        return np.ascontiguousarray(np.concatenate([self.place, self.axis, self.across, self.upward], axis=1))

    def chosen(self, which: NDArray[np.bool_]) -> Shots:
        """Some of them."""
        return Shots(self.place[which], self.axis[which], self.across[which], self.upward[which])


def joined_shots(parts: Sequence[Shots]) -> Shots:
    """Photos of one camera, all together."""
    columns = zip(*((s.place, s.axis, s.across, s.upward) for s in parts), strict=True)
    return (
        Shots(*(np.concatenate(column) for column in columns)) if parts else Shots(*([np.zeros((0, 3))] * 4))
    )


def axes(
    camera: PlanCamera, roll_rad: Floats, pitch_rad: Floats, yaw_rad: Floats, of_camera: NDArray[np.bool_]
) -> tuple[Floats, Floats, Floats]:
    """Axis, across and upward of photos, each (N, 3), east, north and up.

    Parameters
    ----------
    roll_rad, pitch_rad, yaw_rad
        Tait-Bryan angles, yaw first, clockwise from the local frame's north.
    of_camera
        Whose they are: the camera's own, which looks ahead at 0, 0, 0, or the airframe's, on which it looks
        down, tilted forward.
    """
    tilt_rad = math.radians(camera.tilt_deg)
    bolted = np.array(
        [
            [math.sin(tilt_rad), 0.0, math.cos(tilt_rad)],
            [0.0, 1.0, 0.0],
            [math.cos(tilt_rad), 0.0, -math.sin(tilt_rad)],
        ]
    )
    free = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]])
    cr, sr = np.cos(roll_rad), np.sin(roll_rad)
    cp, sp = np.cos(pitch_rad), np.sin(pitch_rad)
    cy, sy = np.cos(yaw_rad), np.sin(yaw_rad)
    # Columns of the matrix from forward, right and down to north, east and down.
    forward = np.stack([cp * cy, cp * sy, -sp], axis=1)
    right = np.stack([sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, sr * cp], axis=1)
    down = np.stack([cr * sp * cy + sr * sy, cr * sp * sy - sr * cy, cr * cp], axis=1)
    found = []
    for k in range(3):
        body = np.where(of_camera[:, None], free[k], bolted[k])
        ned = body[:, :1] * forward + body[:, 1:2] * right + body[:, 2:] * down
        found.append(np.stack([ned[:, 1], ned[:, 0], -ned[:, 2]], axis=1))
    return found[0], found[1], found[2]


def half_tangents(camera: PlanCamera) -> tuple[float, float]:
    """Of half the angles of view, across and upward."""
    pixel = camera.pixel_pitch_m / camera.focal_length_m
    return camera.columns * pixel / 2.0, camera.rows * pixel / 2.0


def outlines(shots: Shots, camera: PlanCamera, ground_m: Floats) -> Floats:
    """Corners of photos on level ground at a height each, (N, 4, 2); NaN above the horizon.

    In order: rear left, rear right, front right, front left.
    """
    wide, high = half_tangents(camera)
    found = np.full((len(shots.place), 4, 2), np.nan)
    for k, (x, y) in enumerate(((-wide, -high), (wide, -high), (wide, high), (-wide, high))):
        ray = shots.axis + x * shots.across + y * shots.upward
        down = -ray[:, 2]
        drop_m = shots.place[:, 2] - ground_m
        meets = (down > 1e-6) & (drop_m > 0.0)
        reach = np.divide(drop_m, down, out=np.full(len(down), np.nan), where=meets)
        found[:, k] = shots.place[:, :2] + ray[:, :2] * reach[:, None]
    return found
