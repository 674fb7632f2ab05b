"""The gimbal of one vehicle's task: pointed before the first collect, anew where the next looks elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mavlink.dialects import Dialect
from mavlink.encoding.gimbal import (
    ARDUPILOT_GIMBALS,
    Gimbal,
    GimbalError,
    Pointing,
    control_items,
    keeps_whole_degrees,
    neutral_item,
    pointing_at,
    pointing_item,
    turning_notes,
)
from mavlink.encoding.options import EncodeError
from mavlink.encoding.task import Task
from mavlink.wire.items import MissionItem, MissionResult


@dataclass(frozen=True, slots=True)
class Pointings:
    """Items to be put between those of the flight.

    Parameters
    ----------
    groups
        By collect in flight order, what must stand before it; empty where the gimbal points there already.
    rest
        Before the landing.
    """

    groups: tuple[tuple[MissionItem, ...], ...] = ()
    rest: tuple[MissionItem, ...] = ()
    notes: tuple[str, ...] = ()

    def before(self, number: int) -> tuple[MissionItem, ...]:
        """What points the gimbal for a collect, counted from 0; nothing behind the last."""
        return self.groups[number] if number < len(self.groups) else ()


def pointings_of(task: Task) -> Pointings:
    """What a task's gimbal is told; nothing where there is none, or nothing to collect.

    Raises
    ------
    EncodeError
        The gimbal cannot be pointed so, or not by this autopilot.
    """
    gimbal, dialect = task.options.gimbal, task.dialect
    if gimbal is None or not task.collects:
        return Pointings()
    if not task.is_px4 and gimbal.device > ARDUPILOT_GIMBALS:
        raise EncodeError(
            f"gimbal device {gimbal.device}: ArduPilot's are numbered 1 to {ARDUPILOT_GIMBALS}, 0 is its"
            " primary one"
        )
    collects = sorted(task.collects, key=lambda collect: collect.start_m)
    try:
        notes = turning_notes(gimbal, collects)
    except GimbalError as error:
        raise EncodeError(str(error)) from error
    cameras = [task.plan.camera(collect.sensor) for collect in collects]
    wanted = [
        pointing_at(gimbal, collect, dialect.autopilot, backwards=camera is not None and camera.tilt_deg < 0)
        for collect, camera in zip(collects, cameras, strict=True)
    ]
    groups = _groups(gimbal, wanted, dialect)
    rest = neutral_item(gimbal, dialect.autopilot)
    for item in {rest, *(item for group in groups for item in group)}:
        # Numbered as if in flight: item 0 of ArduPilot is never looked at.
        result = dialect.answer(replace(item, seq=1))
        if result != MissionResult.ACCEPTED:
            raise EncodeError(f"{dialect.name} refuses the gimbal's command {item.command}: {result.name}")
    looks = {collect.look for collect in collects}
    return Pointings(groups, (rest,), (*_notes(gimbal, dialect, aside=looks != {"down"}), *notes))


def _groups(
    gimbal: Gimbal, wanted: Sequence[Pointing], dialect: Dialect
) -> tuple[tuple[MissionItem, ...], ...]:
    groups: list[tuple[MissionItem, ...]] = []
    pointed: Pointing | None = None
    for pointing in wanted:
        items: tuple[MissionItem, ...] = ()
        if pointing != pointed:
            items = (pointing_item(gimbal, pointing, dialect.autopilot),)
        if pointed is None:
            items = (*control_items(gimbal, dialect.autopilot), *items)
        groups.append(items)
        pointed = pointing
    return tuple(groups)


def _notes(gimbal: Gimbal, dialect: Dialect, *, aside: bool) -> tuple[str, ...]:
    where = "to the side of each pass" if aside else "along each pass"
    notes = [
        f"the gimbal holds the sensor {gimbal.tilt_deg:g}° from straight down, {where}"
        if gimbal.tilt_deg
        else "the gimbal holds the sensor straight down"
    ]
    if keeps_whole_degrees(gimbal, dialect.autopilot) and gimbal.tilt_deg != round(gimbal.tilt_deg):
        pitch_deg = gimbal.tilt_deg - 90.0
        notes.append(
            f"ArduPilot keeps whole degrees of the gimbal's pitch: {round(pitch_deg)}° is sent for"
            f" {pitch_deg:g}°; mount keeps fractions"
        )
    if gimbal.protocol == "mount" and dialect.name == "ArduCopter":
        notes.append(
            "ArduCopter turns its nose by DO_MOUNT_CONTROL where the gimbal has no yaw: manager leaves it"
        )
    if gimbal.device and dialect.autopilot == "px4":
        notes.append(
            f"PX4 turns the one gimbal it knows, whichever device is named ({gimbal.device} is here)"
        )
    return tuple(notes)
