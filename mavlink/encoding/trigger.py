"""The cameras of a plan: what has them take the photos of each collect, and rest between.

By distance the shutter is released anew at each collect: a first photo at once, the others every so many
metres, and the last one by the very item that stops it. Both autopilots count metres from where the photo
before was taken and look some hundredths of a second apart, so each spacing comes out a little long: that is
taken off. What is ordered is a little longer than planned, for no photo may fall due just before the last.

Source: MAVLink ``common.xml``; ArduPilot ``AP_Camera_Backend::update`` (50 Hz), PX4 ``camera_trigger``
(20 Hz).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from mavlink.dialects import Autopilot
from mavlink.encoding.options import DEFAULT_PAYLOAD, EncodeError
from mavlink.encoding.payload import (
    JointPayload,
    OutputPayload,
    Payload,
    PayloadError,
    TriggerPayload,
    off_items,
    parse_payload,
    parts_of,
    separated,
)
from mavlink.encoding.task import Task
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import Collect, Photos, Plan, Trigger

#: How often each autopilot looks, and how late a photo by distance comes on average, in seconds of flight:
#: 0.33 m at 22.4 m/s by ArduPlane, 0.5 m at 14 m/s by PX4.
_LOOK_S: Final[Mapping[Autopilot, float]] = {"ardupilot": 0.02, "px4": 0.05}
_LATE_S: Final[Mapping[Autopilot, float]] = {"ardupilot": 0.015, "px4": 0.035}
#: By how much the way between the two ends of a collect may be longer than planned: wings pass places late
#: or early by some tenths of a second, what hovers comes to a stop there.
_END_S: Final = 0.5
_END_HOVERING_S, _END_HOVERING_M = 0.1, 1.0
#: A run of photos is made longer by at most this part of a spacing, and each spacing by at most that.
_MOST_LONGER, _MOST_STRETCHED = 0.5, 0.1
#: A run by time may have so many photos more, for an aircraft slower than planned.
_MOST_MORE: Final = 0.25
_SHOOT: Final = 1


@dataclass(frozen=True, slots=True)
class Switch:
    """What stands at the beginning and at the end of a collect, and what switches off in any case."""

    on: tuple[MissionItem, ...]
    off: tuple[MissionItem, ...]
    rest: tuple[MissionItem, ...]


def payload_of(plan: Plan, vehicle: str, wanted: Payload | None) -> Payload:
    """How the sensors of a vehicle's collects are switched.

    Parameters
    ----------
    wanted
        None for what the plan says: its cameras by their triggers, all else by the usual output.

    Raises
    ------
    PayloadError
        A trigger is wanted of a plan without cameras.
    """
    collects = plan.collects_of(vehicle)
    cameras = [plan.camera(collect.sensor) for collect in collects]
    if wanted is None:
        triggers: set[Trigger] = {camera.trigger for camera in cameras if camera is not None}
        if not triggers:
            return DEFAULT_PAYLOAD
        outputs: tuple[OutputPayload | TriggerPayload, ...] = (DEFAULT_PAYLOAD,) if None in cameras else ()
        wanted = _joined((*outputs, *(TriggerPayload(by) for by in sorted(triggers))))
    elif any(isinstance(part, TriggerPayload) for part in parts_of(wanted)) and not any(cameras):
        raise PayloadError(f"no pass of {vehicle!r} is one of a camera: there is nothing to trigger")
    return _joined(
        TriggerPayload(part.by, _largest(plan, vehicle, part.by))
        if isinstance(part, TriggerPayload)
        else part
        for part in parts_of(wanted)
    )


def specified(plan: Plan, vehicle: str, wanted: str | None) -> str | None:
    """A specification with what it leaves to the plan filled in; None where the usual output does for all."""
    payload = payload_of(plan, vehicle, None if wanted is None else parse_payload(wanted))
    triggers = [_text(part) for part in parts_of(payload) if isinstance(part, TriggerPayload)]
    if not triggers:
        return wanted
    if wanted is None:
        outputs = ["relay:0"] if len(triggers) < len(parts_of(payload)) else []
    else:
        outputs = [each for each in separated(wanted) if not each.startswith("trigger")]
    return "+".join([*outputs, *triggers])


def _text(part: TriggerPayload) -> str:
    # Rounded up: what is farther apart than this is a gap.
    spacing = "" if part.spacing is None else f"={math.ceil(part.spacing * 100.0) / 100.0:g}"
    return f"trigger:{part.by}{spacing}"


def _joined(parts: Iterable[OutputPayload | TriggerPayload]) -> Payload:
    one, *others = parts
    return JointPayload((one, *others)) if others else one


def _largest(plan: Plan, vehicle: str, by: Trigger) -> float | None:
    """The largest spacing of a vehicle's photos; None for a video, and where there are none."""
    spacings = [photos.interval_m for photos in plan.photos_of(vehicle)]
    if by == "time":
        collects = {collect.seq: collect for collect in plan.collects_of(vehicle)}
        spacings = [
            interval_s(photos, collects[photos.seq])
            for photos in plan.photos_of(vehicle)
            if photos.seq in collects
        ]
    return max(spacings, default=None) if by != "video" else None


def trigger_of(plan: Plan, collect: Collect, payload: Payload) -> Trigger | None:
    """What releases the camera of a collect; None where its sensor is none, or an output stands for it."""
    camera = plan.camera(collect.sensor)
    triggers = [part.by for part in parts_of(payload) if isinstance(part, TriggerPayload)]
    if camera is None or not triggers:
        return None
    return camera.trigger if camera.trigger in triggers else triggers[0]


def camera_switch(task: Task, collect: Collect, by: Trigger) -> Switch:
    """The items of one collect of a camera, not yet numbered; EncodeError where its photos are not known."""
    rest = off_items(TriggerPayload(by))
    if by == "video":
        return Switch((_item(Command.VIDEO_START_CAPTURE),), rest, rest)
    photos = next((p for p in task.plan.photos_of(task.vehicle.name) if p.seq == collect.seq), None)
    if photos is None or not photos.places:
        raise EncodeError(f"collect {collect.seq} of {task.vehicle.name!r} has no photos: plan again")
    count = len(photos.places)
    if count == 1:
        return Switch((_single(by),), (), rest)
    if by == "time":
        return _by_time(task, photos, collect, rest)
    spacing_m = ordered_spacing_m(task, photos, collect)
    on = _item(Command.DO_SET_CAM_TRIGG_DIST, spacing_m, 0.0, 1.0)
    return Switch((on,), (_item(Command.DO_SET_CAM_TRIGG_DIST, 0.0, 0.0, 1.0),), rest)


def ordered_spacing_m(task: Task, photos: Photos, collect: Collect) -> float:
    """The distance to order so that one photo less than planned is taken before the end of a collect."""
    speed_m_s, gaps = _speed_m_s(collect), len(photos.places) - 1
    look_m, late_m = (table[task.dialect.autopilot] * speed_m_s for table in (_LOOK_S, _LATE_S))
    end_m = _END_HOVERING_S * speed_m_s + _END_HOVERING_M if task.hovers else _END_S * speed_m_s
    # At a steady speed photos may come less late than on average, all of them alike.
    longer_m = min(end_m + look_m / 4.0 * gaps, _MOST_LONGER * photos.interval_m) / gaps
    if gaps > 1:
        longer_m = min(longer_m, _MOST_STRETCHED * photos.interval_m)
    return round(photos.interval_m + longer_m - min(late_m, _MOST_STRETCHED * photos.interval_m), 3)


def interval_s(photos: Photos, collect: Collect) -> float:
    """Time between two photos of a collect: as published, else by its speed."""
    if photos.interval_s is not None:
        return photos.interval_s
    return photos.interval_m / _speed_m_s(collect)


def _by_time(task: Task, photos: Photos, collect: Collect, rest: tuple[MissionItem, ...]) -> Switch:
    """A counted run of photos, which ends by itself should nothing else end it.

    ArduPilot takes the last one at the collect's end. PX4 hands single photos to another driver than runs:
    there the last of the run comes half an interval before the end.
    """
    gaps = len(photos.places) - 1
    planned_s = interval_s(photos, collect)
    end_s = min(_END_S, _MOST_LONGER * planned_s) / gaps
    if gaps > 1:
        end_s = min(end_s, _MOST_STRETCHED * planned_s)
    ordered_s = planned_s - end_s if task.is_px4 else planned_s + end_s - _LATE_S["ardupilot"]
    most = gaps + 1 + math.ceil(_MOST_MORE * gaps)
    on = _item(Command.IMAGE_START_CAPTURE, 0.0, round(ordered_s, 3), float(most))
    last = () if task.is_px4 else (_single("time"),)
    return Switch((on,), (*last, *rest), rest)


def _single(by: Trigger) -> MissionItem:
    if by == "time":
        return _item(Command.IMAGE_START_CAPTURE, 0.0, 0.0, 1.0)
    return MissionItem(0, Frame.MISSION, Command.DO_DIGICAM_CONTROL, x=_SHOOT)


def _speed_m_s(collect: Collect) -> float:
    """Over ground, as planned."""
    time_s = collect.end_s - collect.start_s
    if not (math.isfinite(time_s) and time_s > 0.0):
        raise EncodeError(f"collect {collect.seq} takes no time: plan again")
    return (collect.end_m - collect.start_m) / time_s


def _item(command: int, param1: float = 0.0, param2: float = 0.0, param3: float = 0.0) -> MissionItem:
    return MissionItem(0, Frame.MISSION, command, param1=param1, param2=param2, param3=param3)


def trigger_notes(task: Task, payload: Payload) -> tuple[str, ...]:
    """What is ordered of the cameras, for people."""
    collects = {c.seq: c for c in task.collects if trigger_of(task.plan, c, payload) is not None}
    photos = [p for p in task.plan.photos_of(task.vehicle.name) if p.seq in collects]
    notes = []
    for by in sorted({t for c in task.collects if (t := trigger_of(task.plan, c, payload)) is not None}):
        mine = [p for p in photos if trigger_of(task.plan, collects[p.seq], payload) == by]
        taken = sum(len(p.places) for p in mine)
        if by == "video":
            notes.append("each pass of a camera is a video: VIDEO_START_CAPTURE to VIDEO_STOP_CAPTURE")
        elif by == "time":
            notes.append(f"{taken} photos by time, a counted run on each pass (IMAGE_START_CAPTURE)")
        else:
            notes.append(
                f"{taken} photos by distance (DO_SET_CAM_TRIGG_DIST): the first and the last of a pass at its"
                " ends"
            )
    return tuple(notes)
