"""The shutter of the simulated aircraft's camera: photos by distance, by time, one by one; videos.

Photos by distance fall due where the autopilot looks, ArduPilot at every step and PX4 twenty times a second,
and count from where the one before was taken. PX4 takes no photos by distance out of its mission; ArduPilot
goes on with them whatever it flies. What comes sooner than the camera can is taken later by ArduPilot and
left out by PX4.

Source: MAVLink ``common.xml`` (CAMERA_FEEDBACK, CAMERA_IMAGE_CAPTURED, CAMERA_TRIGGER); ArduPilot
``AP_Camera_Backend``, PX4 ``camera_trigger`` and ``Navigator::disable_camera_trigger``.
"""

from __future__ import annotations

import math
import random

from mavlink.sim.dynamics import AircraftState
from mavlink.sim.faults import Fault
from mavlink.sim.geodesy import Place, distance_m
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.messages import Message

#: PX4's camera trigger sleeps 50 ms between two looks, never quite evenly.
_PX4_LOOKS_S = (0.03, 0.07)
#: Every so many photos the faults ``photos_lost`` and ``feedback_lost`` strike.
_LOST_EVERY = 7
_SOON = 1e-9


class Shutter:
    """Releases the camera.

    Attributes
    ----------
    taken
        Photos on its card.
    broken
        Whether it takes none, whatever is ordered.
    video_since_s
        When the video began; None while there is none.
    """

    def __init__(self, settings: SimSettings, faults: frozenset[Fault]) -> None:
        self._settings = settings
        self._photos_lost = Fault.PHOTOS_LOST in faults
        self._feedback_lost = Fault.FEEDBACK_LOST in faults
        self.taken = 0
        self.broken = False
        self.video_since_s: float | None = None
        self._released = 0
        self._spacing_m = 0.0
        self._interval_s = 0.0
        self._left: int | None = None
        self._pending = False
        self._last_place: Place | None = None
        self._last_s = -math.inf
        self._look_s = self._due_s = -math.inf
        self._chance = random.Random(settings.seed)

    @property
    def interval_s(self) -> float:
        """Of the run by time that goes on; 0 while there is none."""
        return self._interval_s

    def by_distance(self, spacing_m: float, state: AircraftState, *, at_once: bool) -> list[Message]:
        """Every so many metres from here on; 0 ends it. ``at_once`` takes one now in any case."""
        px4 = self._settings.autopilot is Flavour.PX4
        self._spacing_m, self._last_place, self._pending = max(spacing_m, 0.0), state.place, False
        return self.release(state) if at_once or (px4 and spacing_m > 0.0) else []

    def by_time(self, interval_s: float, count: int | None, state: AircraftState) -> list[Message]:
        """So many photos at an interval, the first at once; without an end where the count is None."""
        self._interval_s, self._left, self._due_s = interval_s, count, state.time_s
        return self._next(state)

    def stop(self) -> None:
        """End a run by time."""
        self._interval_s, self._left, self._pending = 0.0, None, False

    def rest(self) -> bool:
        """The mission is left: PX4 takes no more photos of its own accord. Whether it took any before."""
        if self._settings.autopilot is not Flavour.PX4 or not (self._spacing_m or self._interval_s):
            return False
        self._spacing_m = 0.0
        self.stop()
        return True

    def step(self, state: AircraftState) -> list[Message]:
        """Photos that are due."""
        if self._pending:
            return self.release(state)
        if self._interval_s > 0.0:
            return self._next(state) if state.time_s >= self._due_s - _SOON else []
        if self._spacing_m <= 0.0:
            return []
        if self._settings.autopilot is Flavour.PX4:
            if state.time_s < self._look_s - _SOON:
                return []
            self._look_s = state.time_s + self._chance.uniform(*_PX4_LOOKS_S)
        assert self._last_place is not None
        if distance_m(self._last_place, state.place) < self._spacing_m:
            return []
        self._last_place = state.place
        return self.release(state)

    def release(self, state: AircraftState) -> list[Message]:
        """Take one photo, and tell of it."""
        px4 = self._settings.autopilot is Flavour.PX4
        if state.time_s - self._last_s < self._settings.camera_interval_s - _SOON:
            self._pending = not px4
            return []
        self._pending = False
        self._last_place, self._last_s = state.place, state.time_s
        number, self._released = self._released, self._released + 1
        told = [_trigger(state, number)] if px4 else []
        struck = self._released % _LOST_EVERY == 0
        if self.broken or (self._photos_lost and struck):
            return told
        self.taken += 1
        if self._feedback_lost and struck:
            return []
        return [*told, self._feedback(state, number)]

    def _next(self, state: AircraftState) -> list[Message]:
        # ArduPilot counts from the photo before, a camera of PX4's by its own clock.
        since_s = self._due_s if self._settings.autopilot is Flavour.PX4 else state.time_s
        self._due_s = since_s + self._interval_s
        told = self.release(state)
        if self._left is not None:
            self._left -= 1
            if self._left <= 0:
                self.stop()
        return told

    def _feedback(self, state: AircraftState, number: int) -> Message:
        lat, lon = round(state.lat_deg * 1e7), round(state.lon_deg * 1e7)
        relative_m = state.altitude_m - self._settings.home.altitude_m
        if self._settings.autopilot is Flavour.ARDUPILOT:
            return Message(
                "CAMERA_FEEDBACK",
                {
                    "time_usec": round(state.time_s * 1e6),
                    "target_system": 0,
                    "cam_idx": 0,
                    "img_idx": (number + 1) & 0xFFFF,
                    "lat": lat,
                    "lng": lon,
                    "alt_msl": state.altitude_m,
                    "alt_rel": relative_m,
                    "roll": math.degrees(state.bank_rad),
                    "pitch": math.degrees(state.pitch_rad),
                    "yaw": math.degrees(state.heading_rad),
                    "foc_len": 0.0,
                    "flags": 0,
                    "completed_captures": self.taken & 0xFFFF,
                },
            )
        return Message(
            "CAMERA_IMAGE_CAPTURED",
            {
                "time_boot_ms": _ms(state),
                "time_utc": 0,
                "camera_id": 1,
                "lat": lat,
                "lon": lon,
                "alt": round(state.altitude_m * 1000.0),
                "relative_alt": round(relative_m * 1000.0),
                "q": quaternion(state.bank_rad, state.pitch_rad, state.heading_rad),
                "image_index": number,
                "capture_result": 1,
                "file_url": "",
            },
        )


def _trigger(state: AircraftState, number: int) -> Message:
    """What PX4 says of an order to the shutter, whatever becomes of it."""
    return Message("CAMERA_TRIGGER", {"time_usec": round(state.time_s * 1e6), "seq": number})


def quaternion(roll_rad: float, pitch_rad: float, yaw_rad: float) -> tuple[float, float, float, float]:
    """Attitude quaternion (w, x, y, z) of Tait-Bryan angles, yaw first."""
    cr, sr = math.cos(roll_rad / 2.0), math.sin(roll_rad / 2.0)
    cp, sp = math.cos(pitch_rad / 2.0), math.sin(pitch_rad / 2.0)
    cy, sy = math.cos(yaw_rad / 2.0), math.sin(yaw_rad / 2.0)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def _ms(state: AircraftState) -> int:
    return round(state.time_s * 1000.0)
