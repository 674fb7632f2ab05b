"""PX4's onboard logs, read by its own reader.

Source: PX4's ``msg/``: VehicleGlobalPosition, VehicleAttitude, HomePosition, ActuatorOutputs (an instance for
each port, pulses in microseconds), CameraCapture, CameraTrigger, SensorGps. Timestamps are microseconds since
boot, those of GLOBAL_POSITION_INT. A capture is a trigger with its place; of a log with triggers alone those
are photos that ``camera_feedback`` would have taken: with CAM_CAP_FBACK the ones that the camera confirmed.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from pyulog import ULog

from mavlink.formats.errors import FormatError
from mavlink.formats.onboard.log import OnboardLog
from mavlink.state.track import SensorEvent, TrackPoint

MAGIC: Final = b"ULog\x01\x12\x35"
_TOPICS: Final = (
    "vehicle_global_position", "vehicle_attitude", "home_position", "actuator_outputs", "camera_capture",
    "camera_trigger", "sensor_gps", "vehicle_gps_position",
)  # fmt: skip
_PORT_OUTPUTS: Final = 16
_ATTITUDE_S: Final = 1.0

Data = dict[str, NDArray[Any]]


def read_ulog(path: Path) -> OnboardLog:
    """A ``.ulg``; raises FormatError where it holds no places."""
    with path.open("rb") as file:
        log = ULog(file, list(_TOPICS))
    topics: dict[tuple[str, int], Data] = {(d.name, d.multi_id): d.data for d in log.data_list}
    places = topics.get(("vehicle_global_position", 0))
    home = topics.get(("home_position", 0))
    if places is None or home is None or not len(places["timestamp"]) or not len(home["timestamp"]):
        raise FormatError("the log holds no places (vehicle_global_position), or no home_position")
    points = _points(places, topics.get(("vehicle_attitude", 0)), home)
    captures = topics.get(("camera_capture", 0))
    confirmed = log.initial_parameters.get("CAM_CAP_FBACK", 0) >= 1
    return OnboardLog(
        "px4",
        points,
        _triggered(topics.get(("camera_trigger", 0)), points, confirmed=confirmed)
        if captures is None
        else _photos(captures, float(home["alt"][-1])),
        {},
        _pulses(topics),
        {name: float(value) for name, value in log.initial_parameters.items()},
        _clock_s(topics),
    )


def _points(places: Data, attitudes: Data | None, home: Data) -> tuple[TrackPoint, ...]:
    times_s = places["timestamp"] / 1e6
    # Home as it was set last before each place; before the first, that.
    rows = np.maximum(np.searchsorted(home["timestamp"], places["timestamp"], side="right") - 1, 0)
    relative_m = places["alt"] - home["alt"][rows]
    angles = np.full((len(times_s), 3), np.nan)
    if attitudes is not None and len(attitudes["timestamp"]):
        at_s = attitudes["timestamp"] / 1e6
        after = np.clip(np.searchsorted(at_s, times_s), 0, len(at_s) - 1)
        before = np.maximum(after - 1, 0)
        row = np.where(np.abs(at_s[before] - times_s) <= np.abs(at_s[after] - times_s), before, after)
        angles = _angles_deg(*(attitudes[f"q[{k}]"][row] for k in range(4)))
        angles[np.abs(at_s[row] - times_s) > _ATTITUDE_S] = np.nan
    made = []
    for k, time_s in enumerate(times_s.tolist()):
        roll, pitch, yaw = (None if np.isnan(angle) else float(angle) for angle in angles[k])
        place = (float(places["lon"][k]), float(places["lat"][k]))
        heading = None if yaw is None else yaw % 360.0
        made.append(
            TrackPoint(
                time_s, *place, float(relative_m[k]), float(places["alt"][k]), heading, None, roll, pitch
            )
        )
    return tuple(made)


def _angles_deg(w: NDArray[Any], x: NDArray[Any], y: NDArray[Any], z: NDArray[Any]) -> NDArray[np.float64]:
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    angles: NDArray[np.float64] = np.degrees(np.stack([roll, pitch, yaw], axis=1))
    return angles


def _triggered(
    triggers: Data | None, points: tuple[TrackPoint, ...], *, confirmed: bool
) -> tuple[SensorEvent, ...]:
    """A photo at each trigger, with the place and attitude of the track's nearest point."""
    if triggers is None:
        return ()
    times_s = np.array([point.time_s for point in points])
    feedback = triggers.get("feedback", np.zeros(len(triggers["timestamp"]), dtype=bool))
    made = []
    for k, time_s in enumerate((triggers["timestamp"] / 1e6).tolist()):
        nearest = int(np.argmin(np.abs(times_s - time_s)))
        if abs(times_s[nearest] - time_s) > _ATTITUDE_S or (confirmed and not feedback[k]):
            continue
        at = points[nearest]
        place = (at.lon_deg, at.lat_deg, at.relative_m)
        angles = (at.heading_deg, at.roll_deg, at.pitch_deg)
        made.append(
            SensorEvent(time_s, "photo", "camera", *place, int(triggers["seq"][k]), at.amsl_m, *angles)
        )
    return tuple(made)


def _photos(captures: Data, home_m: float) -> tuple[SensorEvent, ...]:
    angles = _angles_deg(*(captures[f"q[{k}]"] for k in range(4)))
    return tuple(
        SensorEvent(
            float(captures["timestamp"][k]) / 1e6,
            "photo",
            "camera",
            float(captures["lon"][k]),
            float(captures["lat"][k]),
            float(captures["alt"][k]) - home_m,
            int(captures["seq"][k]),
            float(captures["alt"][k]),
            float(angles[k, 2]) % 360.0,
            float(angles[k, 0]),
            float(angles[k, 1]),
        )
        for k in np.flatnonzero(captures["result"] == 1).tolist()
    )


def _pulses(topics: dict[tuple[str, int], Data]) -> dict[int, tuple[tuple[float, float], ...]]:
    found: dict[int, tuple[tuple[float, float], ...]] = {}
    for (name, port), data in topics.items():
        if name != "actuator_outputs":
            continue
        times_s = (data["timestamp"] / 1e6).tolist()
        for number in range(_PORT_OUTPUTS):
            column = data.get(f"output[{number}]")
            if column is not None:
                pulses = column.astype(np.float64).tolist()
                found[port * _PORT_OUTPUTS + number + 1] = tuple(zip(times_s, pulses, strict=True))
    return found


def _clock_s(topics: dict[tuple[str, int], Data]) -> float | None:
    for name in ("vehicle_gps_position", "sensor_gps"):
        data = topics.get((name, 0))
        if data is None or "time_utc_usec" not in data:
            continue
        rows = np.flatnonzero(data["time_utc_usec"] > 0)
        if len(rows):
            return float((int(data["time_utc_usec"][rows[-1]]) - int(data["timestamp"][rows[-1]])) / 1e6)
    return None
