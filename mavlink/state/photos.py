"""Photos as they were taken: when, where, and which way the camera or its aircraft lay then.

Source: MAVLink ``common.xml`` and ``ardupilotmega.xml``: CAMERA_FEEDBACK (180), CAMERA_IMAGE_CAPTURED (263);
ArduPilot ``AP_Camera_Backend::prep_mavlink_msg_camera_feedback`` and PX4 ``camera_feedback``, both of which
tell the attitude of the airframe; a camera of the camera protocol tells its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from mavlink.state.track import SensorEvent

#: Whose attitude was told: that of the airframe the camera is mounted to, or the camera's own.
PhotoSource = Literal["autopilot", "camera"]


@dataclass(frozen=True, slots=True)
class PhotoTaken:
    """One photo that a camera or its autopilot says was taken; an order alone is none.

    Parameters
    ----------
    time_s
        The vehicle's time since boot.
    lon_deg, lat_deg, altitude_amsl_m
        Where: of the camera, else the vehicle's place when it was heard of.
    roll_rad, pitch_rad, yaw_rad
        Tait-Bryan angles, yaw first: right wing down, nose up, clockwise from true north (0 to 2 pi). Of the
        airframe where ``source`` is ``autopilot``, of the camera itself where it is ``camera``; None where
        none was told.
    index
        Its number in the camera's count; None where none was told.
    """

    time_s: float
    lon_deg: float
    lat_deg: float
    altitude_amsl_m: float
    roll_rad: float | None
    pitch_rad: float | None
    yaw_rad: float | None
    index: int | None
    source: PhotoSource


def photos_among(events: Iterable[SensorEvent]) -> tuple[PhotoTaken, ...]:
    """The photos among a track's events in order of time; those without a place are left out."""
    taken = [photo for event in events if (photo := photo_of(event)) is not None]
    return tuple(sorted(taken, key=lambda photo: photo.time_s))


def photo_of(event: SensorEvent) -> PhotoTaken | None:
    """The photo that an event is; None for a switch, and for a photo taken nobody knows where."""
    lon_deg, lat_deg, amsl_m = event.lon_deg, event.lat_deg, event.amsl_m
    if event.kind != "photo" or lon_deg is None or lat_deg is None or amsl_m is None:
        return None
    return PhotoTaken(
        event.time_s,
        lon_deg,
        lat_deg,
        amsl_m,
        _rad(event.roll_deg),
        _rad(event.pitch_deg),
        _rad(event.heading_deg),
        event.index,
        event.attitude_of,
    )


def _rad(angle_deg: float | None) -> float | None:
    return None if angle_deg is None else math.radians(angle_deg)
