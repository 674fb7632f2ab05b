"""Kinds of sensors, by the ``type`` that scenarios use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from planner.sensors import camera_view, view
from planner.sensors.base import Properties, SeenGround, Sensor
from planner.sensors.camera_reader import read_camera
from planner.sensors.sar_reader import read_sar


@dataclass(frozen=True, slots=True)
class Kind:
    """What is to be known of a kind of sensors.

    Parameters
    ----------
    read
        Its properties, all but ``type``, to a sensor of that kind; None after a finding.
    seen_on_terrain
        Ground one of them sees: the sensor, the line (2, 2) with the sensor on from end to end, the side
        looked to, the level flown over the ground's datum, the ground. Where they follow the ground the level
        may be an array: of places evenly along the line.
    follows
        Whether their passes may follow the ground, up and down; otherwise they are level.
    """

    read: Callable[[Properties], Sensor | None]
    seen_on_terrain: Callable[..., SeenGround]
    follows: bool = False


KINDS: dict[str, Kind] = {
    "sar": Kind(read_sar, view.seen_on_terrain),
    "camera": Kind(read_camera, camera_view.seen_on_terrain, follows=True),
}


def register(name: str, kind: Kind) -> None:
    """Have sensors of a ``type`` read and looked through."""
    KINDS[name] = kind


def seen(sensor: Sensor, *where: Any) -> SeenGround:
    """Ground a sensor sees on terrain; see :class:`Kind`."""
    return KINDS[sensor.kind].seen_on_terrain(sensor, *where)
