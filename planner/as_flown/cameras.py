"""The cameras on board, and what their overlaps come to."""

from __future__ import annotations

import math

from planner.plan import Plan, PlanCamera
from planner.sensors.camera import CameraSensor
from planner.sensors.suite import Suite


def cameras_of(plan: Plan, suite: Suite) -> tuple[PlanCamera, ...]:
    """Those on board of a flight whose plan has no passes of its own: a mission file's."""
    if plan.collects:
        return ()
    return tuple(
        PlanCamera(
            sensor.name, sensor.optics.focal_length_m, sensor.optics.pixel_pitch_m, sensor.optics.columns,
            sensor.optics.rows, sensor.forward_overlap, sensor.side_overlap, math.degrees(sensor.tilt_rad),
            sensor.min_interval_s, sensor.trigger, sensor.model, sensor.spectrum,
        )
        for sensor in suite.sensors
        if isinstance(sensor, CameraSensor)
    )  # fmt: skip


def asked_photos(camera: PlanCamera) -> int:
    """How many photos see a place at least where both overlaps are kept; of a video, how many lanes."""
    forward = 1 if camera.trigger == "video" else math.floor(1.0 / (1.0 - camera.forward_overlap) + 1e-9)
    return forward * math.floor(1.0 / (1.0 - camera.side_overlap) + 1e-9)
