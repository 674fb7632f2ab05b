"""Where a gimbal points, by each message that tells it; photos of a camera in it have its attitude."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mavlink.state.mount import MountAttitude, attitude_of
from mavlink.state.telemetry import VehicleState, updated
from mavlink.state.track import TrackRecorder
from mavlink.wire.messages import Message

HEADING_DEG = 75.0
ROLL_LOCK, PITCH_LOCK, YAW_LOCK, IN_VEHICLE, IN_EARTH = 4, 8, 16, 32, 64


def message(name: str, fields: dict[str, Any], component: int = 154) -> Message:
    """One of the vehicle's, or of its gimbal's."""
    return Message(name, fields, 1, component)


def quaternion(roll_deg: float, pitch_deg: float, yaw_deg: float) -> tuple[float, ...]:
    """By scipy: w first."""
    x, y, z, w = Rotation.from_euler("ZYX", [yaw_deg, pitch_deg, roll_deg], degrees=True).as_quat()
    return (float(w), float(x), float(y), float(z))


def matrix(attitude: MountAttitude) -> Any:
    """What an attitude turns into."""
    angles = [attitude.yaw_deg, attitude.pitch_deg, attitude.roll_deg]
    return Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()


@given(
    st.floats(-180.0, 180.0),
    st.one_of(st.floats(-90.0, 90.0), st.sampled_from([-90.0, 90.0])),
    st.floats(-180.0, 180.0),
    st.sampled_from(
        [(IN_EARTH, False), (IN_VEHICLE, True), (YAW_LOCK, False), (0, True), (YAW_LOCK | IN_VEHICLE, True)]
    ),
)  # fmt: skip
def test_a_device_s_quaternion_is_read_whatever_it_counts_yaw_from(
    roll_deg: float, pitch_deg: float, yaw_deg: float, frame: tuple[int, bool]
) -> None:
    """The same rotation as scipy's, straight down too; yaw from the nose has the heading added."""
    flags, from_nose = frame
    fields = {"flags": flags | ROLL_LOCK | PITCH_LOCK, "q": quaternion(roll_deg, pitch_deg, yaw_deg)}
    found = attitude_of(message("GIMBAL_DEVICE_ATTITUDE_STATUS", fields), HEADING_DEG)
    assert found is not None
    meant = MountAttitude(roll_deg, pitch_deg, yaw_deg + (HEADING_DEG if from_nose else 0.0))
    assert np.abs(matrix(found) - matrix(meant)).max() < 1e-4


def test_the_older_messages_are_read() -> None:
    """MOUNT_STATUS in centidegrees, MOUNT_ORIENTATION in degrees; without a heading neither tells yaw."""
    status = message("MOUNT_STATUS", {"pointing_a": -9000, "pointing_b": 100, "pointing_c": 2500}, 1)
    orientation = message("MOUNT_ORIENTATION", {"roll": 1.0, "pitch": -90.0, "yaw": 25.0})
    for told in (status, orientation):
        assert attitude_of(told, HEADING_DEG) == MountAttitude(1.0, -90.0, 100.0)
        assert attitude_of(told, None) is None
    assert (
        attitude_of(message("MOUNT_ORIENTATION", {"roll": math.nan, "pitch": 0.0, "yaw": 0.0}), 0.0) is None
    )


@pytest.mark.parametrize(
    ("in_gimbal", "waited_s", "whose"),
    [(True, 0.2, "camera"), (True, 5.0, "autopilot"), (False, 0.2, "autopilot")],
)
def test_a_photo_of_a_camera_in_a_gimbal_has_its_attitude(
    in_gimbal: bool, waited_s: float, whose: str
) -> None:
    """Where the gimbal told it just before; else, and where the camera is bolted on, the airframe's."""
    recorder, state = TrackRecorder(in_gimbal=in_gimbal), VehicleState()

    def position(at_s: float) -> Message:
        fields = {
            "time_boot_ms": round(1000.0 * at_s), "lat": 471000000, "lon": 82000000, "alt": 500000,
            "relative_alt": 100000, "vx": 0, "vy": 0, "vz": 0, "hdg": round(100.0 * HEADING_DEG),
        }  # fmt: skip
        return message("GLOBAL_POSITION_INT", fields, 1)

    feedback = {
        "time_usec": 0, "img_idx": 1, "cam_idx": 0, "lat": 471000000, "lng": 82000000, "alt_msl": 500.0,
        "alt_rel": 100.0, "roll": 12.0, "pitch": 3.0, "yaw": HEADING_DEG,
    }  # fmt: skip
    gimbal = {"flags": IN_VEHICLE, "q": quaternion(0.0, -90.0, 10.0)}
    for told in (
        position(10.0),
        message("GIMBAL_DEVICE_ATTITUDE_STATUS", gimbal),
        position(10.0 + waited_s),
        message("CAMERA_FEEDBACK", feedback, 1),
    ):
        state = updated(state, told, 0.0) if told.component_id == 1 else state
        recorder.take(told, state)
    (photo,) = recorder.track().photos
    assert photo.source == whose
    assert photo.pitch_rad is not None
    assert math.degrees(photo.pitch_rad) == pytest.approx(-90.0 if whose == "camera" else 3.0, abs=1e-3)
