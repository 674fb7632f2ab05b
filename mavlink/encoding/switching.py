"""The sensors of one vehicle's task: switched on where a collect begins and off where it ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from mavlink.encoding.options import DEFAULT_PAYLOAD, EncodeError
from mavlink.encoding.payload import (
    ActuatorPayload,
    OutputPayload,
    Payload,
    PayloadError,
    RelayPayload,
    ServoPayload,
    TriggerPayload,
    parts_of,
    switch_items,
)
from mavlink.encoding.task import Task
from mavlink.encoding.trigger import Switch, camera_switch, payload_of, trigger_notes, trigger_of
from mavlink.wire.items import MissionItem, MissionResult
from planner.plan import Collect


@dataclass(slots=True)
class Switching:
    """Items to be put where collects begin and end, asked for in flight order.

    Parameters
    ----------
    switches
        One for each collect, as they begin.
    ends
        Their numbers as they end.
    late_m
        Of a collect by its ``seq``, how far past its beginning the waypoint that begins it must lie.
    """

    switches: tuple[Switch, ...]
    ends: tuple[int, ...]
    notes: tuple[str, ...] = ()
    late_m: Mapping[int, float] = field(default_factory=dict)
    _begun: int = 0
    _ended: int = 0
    _on: list[int] = field(default_factory=list)

    @property
    def rest(self) -> tuple[MissionItem, ...]:
        """Everything off, whatever went before."""
        return tuple(dict.fromkeys(item for switch in self.switches for item in switch.rest))

    def on_delay_m(self, collect: Collect) -> float:
        """How far past a collect's beginning the waypoint that begins it must lie."""
        return self.late_m.get(collect.seq, 0.0)

    def ended(self, count: int, *, begins: bool) -> tuple[MissionItem, ...]:
        """What stands where so many collects end; where collects overlap a sensor stays on to the last end.

        ``begins`` where another begins at that place: its sensor is switched anew.
        """
        gone = self.ends[self._ended : self._ended + count]
        self._ended += count
        self._on = [number for number in self._on if number not in gone]
        return _once(self.switches[n].off for n in gone if begins or not self._held(n))

    def begun(self, count: int, *, ends: bool) -> tuple[MissionItem, ...]:
        """What stands where so many begin; ``ends`` where another has just ended there."""
        new = range(self._begun, self._begun + count)
        self._begun += count
        items = _once(self.switches[n].on for n in new if ends or not self._held(n))
        self._on += new
        return items

    def _held(self, number: int) -> bool:
        """Whether another collect has the same sensor on."""
        return any(self.switches[n].rest == self.switches[number].rest for n in self._on)


def switching_of(task: Task) -> Switching:
    """How a task's sensors are switched; EncodeError where the autopilot takes that not."""
    payload = payload_of(task.plan, task.vehicle.name, task.options.payload)
    collects = sorted(task.collects, key=lambda collect: collect.start_m)
    ends = sorted(range(len(collects)), key=lambda number: collects[number].end_m)
    output, notes = _output(task, payload)
    switches = tuple(_switch(task, collect, payload, output) for collect in collects)
    items = list(dict.fromkeys(item for s in switches for item in (*s.on, *s.off, *s.rest)))
    if not switches:
        items = list(switch_items(output))
    _taken(task, items, payload)
    unlisted = sorted({item.command for item in items if not task.dialect.knows(item.command)})
    notes += tuple(f"it is not known whether {task.dialect.name} takes command {n}" for n in unlisted)
    # A radar that is on early sees no less; a camera has its first photo too early then, and one too many.
    late_m = {c.seq: task.turns_early_m for c in collects if trigger_of(task.plan, c, payload) is not None}
    return Switching(switches, tuple(ends), (*notes, *trigger_notes(task, payload)), late_m)


def _switch(task: Task, collect: Collect, payload: Payload, output: OutputPayload) -> Switch:
    by = trigger_of(task.plan, collect, payload)
    if by is not None:
        return camera_switch(task, collect, by)
    on, off = switch_items(output)
    return Switch((on,), (off,), (off,))


def _output(task: Task, payload: Payload) -> tuple[OutputPayload, tuple[str, ...]]:
    """The payload of what is no camera as the autopilot can switch it, and a note where it is another."""
    outputs = [part for part in parts_of(payload) if not isinstance(part, TriggerPayload)]
    output = outputs[0] if outputs else DEFAULT_PAYLOAD
    if not (task.is_px4 and isinstance(output, RelayPayload)):
        return output, ()
    try:
        actuator = ActuatorPayload(output.relay + 1)
    except PayloadError as error:
        raise EncodeError(f"PX4 has no relays, and no actuator stands for this one: {error}") from error
    used = any(trigger_of(task.plan, collect, payload) is None for collect in task.collects)
    words = f"PX4 takes no relay in missions: actuator {actuator.actuator} is set to 1 for on, -1 for off"
    return actuator, (words,) if used or not task.collects else ()


def _taken(task: Task, items: list[MissionItem], payload: Payload) -> None:
    for item in items:
        # Numbered as if in flight: item 0 of ArduPilot is never looked at.
        result = task.dialect.answer(replace(item, seq=1))
        if result != MissionResult.ACCEPTED:
            servo = any(isinstance(part, ServoPayload) for part in parts_of(payload))
            hint = "; name one of PX4's outputs, main:9 or aux:1" if task.is_px4 and servo else ""
            raise EncodeError(
                f"{task.dialect.name} refuses the payload's command {item.command}: {result.name}{hint}"
            )


def _once(groups: Iterator[tuple[MissionItem, ...]]) -> tuple[MissionItem, ...]:
    """The items of each group, one group that comes again left out."""
    return tuple(item for group in dict.fromkeys(groups) for item in group)
