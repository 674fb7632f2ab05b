"""Commands of a ground station: what the simulated aircraft does with each, and how it answers.

Source: MAVLink ``common.xml`` (COMMAND_LONG, COMMAND_INT, COMMAND_ACK, MAV_RESULT).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Protocol

from mavlink.sim.dynamics import AircraftState
from mavlink.sim.executor import place_of
from mavlink.sim.geodesy import MOST_LATITUDE_DEG, Place
from mavlink.sim.gimbal import Gimbal
from mavlink.sim.modes import Flavour, Mode, mode_of_command
from mavlink.sim.payload import Payload
from mavlink.sim.pilot import Pilot
from mavlink.sim.replies import status_text
from mavlink.sim.settings import SimSettings
from mavlink.sim.streams import NAMES, Streams
from mavlink.wire.items import Command, Frame, MissionItem
from mavlink.wire.messages import Message

_WARNING = 4


class CommandResult(IntEnum):
    """MAV_RESULT."""

    ACCEPTED = 0
    TEMPORARILY_REJECTED = 1
    DENIED = 2
    UNSUPPORTED = 3
    FAILED = 4


@dataclass(frozen=True, slots=True)
class Order:
    """A COMMAND_LONG or COMMAND_INT; ``x`` and ``y`` are latitude and longitude in degrees × 1e7."""

    command: int
    param1: float
    param2: float
    param3: float
    param4: float
    x: int
    y: int
    z: float
    frame: int

    @property
    def item(self) -> MissionItem:
        """The same as a mission item."""
        return MissionItem(
            0,
            self.frame,
            self.command,
            self.param1,
            self.param2,
            self.param3,
            self.param4,
            self.x,
            self.y,
            self.z,
        )


def order_of(message: Message) -> Order:
    """The order in a COMMAND_LONG (degrees in floating point) or a COMMAND_INT."""
    p1, p2, p3, p4 = (message.number(f"param{number}") for number in (1, 2, 3, 4))
    command = message.integer("command")
    if message.name == "COMMAND_INT":
        x, y, z = message.integer("x"), message.integer("y"), message.number("z")
        return Order(command, p1, p2, p3, p4, x, y, z, message.integer("frame"))
    p5, p6, p7 = (message.number(f"param{number}") for number in (5, 6, 7))
    x, y = (round(value * 1e7) if math.isfinite(value) else 0 for value in (p5, p6))
    return Order(command, p1, p2, p3, p4, x, y, p7, Frame.GLOBAL)


class Aircraft(Protocol):
    """What commands act on."""

    pilot: Pilot
    payload: Payload
    gimbal: Gimbal | None
    streams: Streams

    @property
    def settings(self) -> SimSettings:
        """What the aircraft started from."""

    @property
    def state(self) -> AircraftState:
        """Its state now."""

    @property
    def arming_denied(self) -> str:
        """Why it cannot be armed; empty when it can."""

    def message(self, name: str) -> Message | None:
        """A telemetry message by name."""

    def move_home(self, home: Place) -> None:
        """Set another home."""


Outcome = tuple[CommandResult, list[Message]]
#: ArduCopter arms in none of these, AUTO unless AUTO_OPTIONS allows it; planes and PX4 arm in any.
_NOT_ARMABLE = frozenset({Mode.AUTO, Mode.RTL, Mode.LAND, Mode.BRAKE})
_GET_MESSAGE_INTERVAL = 510
#: GET_HOME_POSITION and REQUEST_AUTOPILOT_CAPABILITIES are older than REQUEST_MESSAGE; what they ask for.
_ASKED = {410: 242, 520: 148}
_ASKS = {Command.SET_MESSAGE_INTERVAL, _GET_MESSAGE_INTERVAL, Command.REQUEST_MESSAGE, *_ASKED}
_OK: Outcome = (CommandResult.ACCEPTED, [])


def carry_out(aircraft: Aircraft, order: Order, sender: tuple[int, int]) -> Outcome:
    """Do what is ordered; the result for COMMAND_ACK and what else is to be said."""
    pilot, state = aircraft.pilot, aircraft.state
    asked = _asked(aircraft, order)
    if asked is not None:
        return asked
    match order.command:
        case Command.COMPONENT_ARM_DISARM:
            return _arm(aircraft) if order.param1 == 1.0 else _disarm(aircraft)
        case Command.MISSION_START:
            return _start(aircraft, order)
        case Command.DO_SET_MODE:
            mode = mode_of_command(
                aircraft.settings.autopilot, order.param2, order.param3, hovers=aircraft.settings.hovers
            )
            return change_mode(aircraft, mode)
        case Command.DO_PAUSE_CONTINUE if _is_copter(aircraft):
            # In AUTO it pauses without leaving the mode.
            if not pilot.pause(state, on=order.param1 != 1.0):
                return _denied("Pause denied: no mission is flown")
            return CommandResult.ACCEPTED, _now(aircraft, "MISSION_CURRENT")
        case Command.NAV_TAKEOFF:
            return _take_off(aircraft, order)
        case Command.NAV_LAND if aircraft.settings.hovers or aircraft.settings.autopilot is Flavour.PX4:
            return change_mode(aircraft, Mode.LAND)
        case Command.NAV_LAND:
            # ArduPlane lands by DO_LAND_START or by its mission.
            return CommandResult.UNSUPPORTED, []
        case Command.DO_PAUSE_CONTINUE:
            return change_mode(aircraft, Mode.AUTO if order.param1 == 1.0 else Mode.LOITER)
        case Command.NAV_RETURN_TO_LAUNCH:
            return change_mode(aircraft, Mode.RTL)
        case Command.NAV_LOITER_UNLIM:
            return change_mode(aircraft, Mode.LOITER)
        case Command.DO_REPOSITION:
            return _reposition(aircraft, order)
        case Command.DO_SET_MISSION_CURRENT:
            if aircraft.settings.autopilot is Flavour.PX4:
                return CommandResult.UNSUPPORTED, []
            if not pilot.select(int(order.param1), state):
                return CommandResult.DENIED, []
            return CommandResult.ACCEPTED, _now(aircraft, "MISSION_CURRENT")
        case Command.DO_CHANGE_SPEED:
            pilot.change_speed(order.item)
            return _OK
        case Command.DO_SET_HOME:
            return _set_home(aircraft, order)
        case Command.DO_FENCE_ENABLE if aircraft.settings.autopilot is Flavour.ARDUPILOT:
            return CommandResult.ACCEPTED, [status_text(_WARNING, "Fence is stored, not enforced, here")]
    if aircraft.gimbal is not None and aircraft.gimbal.handle(order.item, sender):
        return _OK
    params = (order.param1, order.param2, order.param3, order.param4)
    said = aircraft.payload.handle(order.command, params, state)
    return (CommandResult.UNSUPPORTED, []) if said is None else (CommandResult.ACCEPTED, said)


def _asked(aircraft: Aircraft, order: Order) -> Outcome | None:
    """What messages are asked for, once or at a rate; None when it is another order."""
    if order.command not in _ASKS:
        return None
    number = _ASKED.get(order.command, int(order.param1))
    name = NAMES.get(number)
    if order.command == _GET_MESSAGE_INTERVAL:
        # 0 is "not available".
        interval_us = aircraft.streams.interval_us(name) if name is not None else 0
        answer = Message("MESSAGE_INTERVAL", {"message_id": number, "interval_us": interval_us})
        return CommandResult.ACCEPTED, [answer]
    if name is None:
        return CommandResult.UNSUPPORTED, []
    if order.command == Command.SET_MESSAGE_INTERVAL:
        aircraft.streams.set_interval(name, order.param2)
        return _OK
    message = aircraft.message(name)
    return (CommandResult.ACCEPTED, [message]) if message else (CommandResult.UNSUPPORTED, [])


def change_mode(aircraft: Aircraft, mode: Mode | None) -> Outcome:
    """Change the flight mode, if the new one can be flown."""
    pilot = aircraft.pilot
    if mode is None:
        return _denied("Mode not simulated")
    if mode is Mode.AUTO:
        reason = pilot.why_not_auto(aircraft.state)
        if reason:
            return _denied(f"Mission not started: {reason}")
    if mode is not pilot.mode:
        pilot.set_mode(mode, aircraft.state)
    return CommandResult.ACCEPTED, _now(aircraft, "HEARTBEAT")


def _arm(aircraft: Aircraft) -> Outcome:
    pilot = aircraft.pilot
    if pilot.armed:
        return _OK
    if _is_copter(aircraft) and pilot.mode in _NOT_ARMABLE:
        return _denied(f"Arm: {pilot.mode.value.capitalize()} mode not armable")
    if aircraft.arming_denied:
        return _denied(f"Arm: {aircraft.arming_denied}")
    pilot.arm()
    return CommandResult.ACCEPTED, [status_text(6, "Throttle armed"), *_now(aircraft, "HEARTBEAT")]


def _disarm(aircraft: Aircraft) -> Outcome:
    if not aircraft.state.on_ground:
        return _denied("Disarm denied: in flight")
    aircraft.pilot.disarm()
    return CommandResult.ACCEPTED, [status_text(6, "Throttle disarmed"), *_now(aircraft, "HEARTBEAT")]


def _start(aircraft: Aircraft, order: Order) -> Outcome:
    """MISSION_START; PX4 begins at the item named, in flight too, and goes on where none is (below 0)."""
    reason = aircraft.pilot.why_not_auto(aircraft.state)
    if reason:
        return _denied(f"Mission not started: {reason}")
    said: list[Message] = []
    if not aircraft.pilot.armed and aircraft.settings.autopilot is Flavour.PX4:
        # On PX4 the order to start a mission is an order to arm.
        result, said = _arm(aircraft)
        if result is not CommandResult.ACCEPTED:
            return result, said
    result, more = change_mode(aircraft, Mode.AUTO)
    if aircraft.settings.autopilot is Flavour.PX4 and order.param1 >= 0.0:
        aircraft.pilot.select(int(order.param1), aircraft.state)
    aircraft.pilot.start()
    return result, said + more


def _take_off(aircraft: Aircraft, order: Order) -> Outcome:
    """PX4 takes the altitude above sea level, ArduCopter above home, and only in GUIDED and armed."""
    pilot, state, settings = aircraft.pilot, aircraft.state, aircraft.settings
    if not state.on_ground:
        return _denied("Takeoff denied: in flight")
    if settings.autopilot is Flavour.PX4:
        named_m = order.z if math.isfinite(order.z) and order.z > state.altitude_m else None
        pilot.take_off(
            state.altitude_m + settings.take_off_height_m if named_m is None else named_m, aircraft.state
        )
    elif _is_copter(aircraft) and pilot.mode is Mode.GUIDED and pilot.armed and order.z > 0.0:
        pilot.take_off(pilot.home.altitude_m + order.z, state)
    else:
        # ArduPlane without rotors takes off in its mission alone.
        return CommandResult.FAILED, []
    return CommandResult.ACCEPTED, _now(aircraft, "HEARTBEAT")


def _is_copter(aircraft: Aircraft) -> bool:
    return aircraft.settings.hovers and aircraft.settings.autopilot is Flavour.ARDUPILOT


def _set_home(aircraft: Aircraft, order: Order) -> Outcome:
    home = aircraft.state.place
    if order.param1 != 1.0:
        home = place_of(replace(order.item, frame=Frame.GLOBAL), home)
    if not (
        math.isfinite(home.altitude_m)
        and abs(home.lat_deg) <= MOST_LATITUDE_DEG
        and abs(home.lon_deg) <= 180.0
    ):
        return _denied("Home denied: no such place")
    aircraft.move_home(home)
    return CommandResult.ACCEPTED, _now(aircraft, "HOME_POSITION")


def _reposition(aircraft: Aircraft, order: Order) -> Outcome:
    state, pilot = aircraft.state, aircraft.pilot
    if state.on_ground:
        return _denied("Reposition denied: on the ground")
    place = place_of(order.item, pilot.home)
    if not math.isfinite(place.altitude_m):
        place = replace(place, altitude_m=state.altitude_m)
    if order.x == 0 and order.y == 0:
        place = replace(place, lat_deg=state.lat_deg, lon_deg=state.lon_deg)
    pilot.set_mode(Mode.GUIDED, state, place)
    return CommandResult.ACCEPTED, _now(aircraft, "HEARTBEAT")


def _denied(reason: str) -> Outcome:
    return CommandResult.DENIED, [status_text(_WARNING, reason)]


def _now(aircraft: Aircraft, name: str) -> list[Message]:
    message = aircraft.message(name)
    return [message] if message is not None else []
