"""How each flight command is carried out, when it is refused, and what shows that it was done."""

from __future__ import annotations

import contextlib
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Final

from app.services.vehicles.order_book import Order, OrderOutcome
from app.services.vehicles.recorder import is_flying
from app.services.vehicles.said import EXPLAINED_S, refusal, said_of
from app.services.vehicles.vehicle import Vehicle
from mavlink.encoding.options import DEFAULT_PAYLOAD
from mavlink.encoding.payload import parse_payload
from mavlink.errors import TransferFailedError
from mavlink.state.modes import (
    LANDING_MODES,
    MISSION_MODES,
    RETURN_MODES,
    WAITING_MODES,
    takes_off_when_armed,
)
from mavlink.state.passes import landing_of, lead_in
from mavlink.state.telemetry import VehicleState
from mavlink.station.client import VehicleClient
from mavlink.transfer.command import CommandOutcome
from mavlink.wire.items import MissionItem
from planner.errors import Finding

#: An order that was accepted and is not shown within this time is not known to be carried out.
SETTLE_S: Final = 30.0

Told = tuple[OrderOutcome, str]
Shows = Callable[[VehicleState], bool]


@dataclass(frozen=True, slots=True)
class Wish:
    """What somebody wants a vehicle to do.

    Parameters
    ----------
    seq
        Item, for ``goto_item``.
    arm_first
        ``start`` arms a disarmed aircraft.
    hold_first
        ``arm`` first puts the aircraft into a mode that keeps it where it is.
    as_held
        ``start`` and ``arm`` are given whatever mission is on board.
    payload
        What ``sensor_off`` switches; None for that of the mission held.
    """

    command: str
    seq: int | None = None
    arm_first: bool = False
    hold_first: bool = False
    payload: str | None = None
    as_held: bool = False


class OrderRefusedError(Exception):
    """It was not carried out, for a reason that names the way out."""

    def __init__(self, rule: str, message: str, fix: str) -> None:
        self.finding = Finding("command", rule, message, fix)
        super().__init__(message)


async def _settled(
    vehicle: Vehicle,
    order: Order,
    giving: Awaitable[CommandOutcome],
    shows: Shows,
    reason: str = "",
    proves: Shows | None = None,
) -> Told:
    """Give an order and wait until the vehicle shows that it is carried out.

    Without an answer it is done only where what was heard since proves it: by ``shows``, where nothing
    stricter is given.
    """
    client = vehicle.client
    begun_s = client.now_s
    order.sent = True
    outcome = await giving
    if outcome.result is not None and not outcome.accepted:
        raise await _refusal(client, outcome, begun_s, order)
    if outcome.result is None:
        if not client.state.connected:
            return "unknown", f"sent, but it was last heard {client.silent_s:.0f} s ago: it may hear or not"
        since = client.state.heard_s is not None and client.state.heard_s > begun_s
        if since and (proves or shows)(client.state):
            return "done", "it never answered, and shows it all the same"
        return "unknown", str(outcome)
    order.reason = f"accepted, not shown yet: mode {client.state.mode}"
    try:
        await client.wait_for(shows, SETTLE_S)
    except TimeoutError:
        return "unknown", f"accepted, but the vehicle does not show it: mode {client.state.mode}"
    return "done", reason


async def _refusal(
    client: VehicleClient, outcome: CommandOutcome, begun_s: float, order: Order
) -> OrderRefusedError:
    with contextlib.suppress(TimeoutError):
        await client.wait_for(lambda state: bool(said_of(state, outcome.command, begun_s)), EXPLAINED_S)
    state = client.state
    message = refusal(state, outcome, begun_s)
    if order.command == "disarm" and state.armed and state.landed is not True:
        return OrderRefusedError(
            "in-flight", message, "land first: send rtl or land, and disarm on the ground"
        )
    return OrderRefusedError("command-refused", message, "see what the vehicle says, and preflight")


def _in(vehicle: Vehicle, modes: frozenset[str]) -> Shows:
    """Whether one of these modes is shown; vehicles whose modes nobody knows are believed."""
    if vehicle.state.autopilot == "generic":
        return lambda _: True
    return lambda state: state.mode in modes


def _armed(state: VehicleState) -> bool:
    return state.armed


def _is_copter(state: VehicleState) -> bool:
    return state.autopilot == "ardupilot" and state.type == "multirotor"


async def _arm(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    state = vehicle.client.state
    if state.armed:
        return "done", "it was armed already"
    if takes_off_when_armed(state.mode):
        if not wish.hold_first:
            raise OrderRefusedError(
                "mode-would-take-off",
                f"armed in mode {state.mode or 'unknown'} the aircraft may take off at once",
                "send start to have it take off, or arm with hold_first to keep it where it is",
            )
        await _hold_on_ground(vehicle, order)
    return await _settled(vehicle, order, vehicle.client.arm(), _armed)


async def _hold_on_ground(vehicle: Vehicle, order: Order) -> None:
    """Into a mode in which arming moves nothing; OrderRefusedError where it does not show it."""
    shows: Shows = lambda state: not takes_off_when_armed(state.mode)  # noqa: E731 - typed
    told, reason = await _settled(vehicle, order, vehicle.client.hold(), shows)
    if told != "done":
        raise OrderRefusedError(
            "mode-would-take-off",
            f"not armed: no mode that keeps it on the ground was shown ({reason})",
            "change the mode, and arm when it is shown",
        )


async def _start(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    client = vehicle.client
    armed_here = False
    if not client.state.armed:
        if not wish.arm_first:
            raise OrderRefusedError(
                "not-armed",
                "the aircraft is not armed, and start arms nothing by itself",
                "send arm, then start; or start with arm_first",
            )
        if takes_off_when_armed(client.state.mode):
            await _hold_on_ground(vehicle, order)
        told = await _settled(vehicle, order, client.arm(), _armed)
        if told[0] != "done":
            return told
        armed_here = True
    shows: Shows = lambda state: state.armed and _in(vehicle, MISSION_MODES)(state)  # noqa: E731 - typed
    flying = is_flying(client.state)
    reason = "it was in flight: it goes on with the mission at its current item" if flying else ""
    if flying and (unseen := await _unseen(vehicle, client)):
        reason = f"it was in flight: {unseen}"
    try:
        return await _settled(vehicle, order, client.start_mission(), shows, reason)
    except OrderRefusedError as error:
        if not armed_here:
            raise
        again = await client.disarm()
        words = "it is disarmed again" if again.accepted else f"and it stays armed ({again})"
        finding = error.finding
        raise OrderRefusedError(finding.rule, f"{error}; {words}", finding.fix) from error


async def _disarm(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    return await _settled(vehicle, order, vehicle.client.disarm(), lambda state: not state.armed)


async def _pause(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    client = vehicle.client
    if not _is_copter(client.state):
        return await _settled(vehicle, order, client.pause(), _in(vehicle, WAITING_MODES))
    # It stays in AUTO, and not every version says that it is paused.
    told = await _settled(vehicle, order, client.pause(), lambda _: True)
    if told[0] == "done":
        vehicle.safety.interrupt("the mission is paused")
    return told


async def _resume(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    client = vehicle.client
    if not client.state.armed:
        raise OrderRefusedError(
            "not-armed", "the aircraft is not armed: there is nothing to go on with", "send start"
        )
    reason = await _unseen(vehicle, client)
    return await _settled(vehicle, order, client.resume(), _in(vehicle, MISSION_MODES), reason)


async def _unseen(vehicle: Vehicle, client: VehicleClient) -> str:
    """What a mission that is gone on with does not see, and which item it is seen from; empty for nothing."""
    left, cut = vehicle.safety.left_out(client.state), vehicle.safety.cut_pass(client.state)
    if left:
        between = ", ".join(f"{run[0]} to {run[-1]}" for run in left)
        reason = (
            f"it goes on at item {client.state.mission_current}, where its return led: the passes of items "
            f"{between} are left out"
        )
    elif cut is not None:
        reason = (
            f"the sensor was switched off in the pass of items {cut[0]} to {cut[-1]}: what is left of it is "
            "not seen"
        )
    else:
        return ""
    first = left[0] if left else cut
    assert first is not None
    with contextlib.suppress(OrderRefusedError):
        items = await _mission_of(vehicle, client)
        begin = lead_in(items, first, vehicle.safety.passes, hovers=client.state.type == "multirotor")
        reason += f"; {begin}"
    return reason


async def _rtl(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    back = _in(vehicle, RETURN_MODES | LANDING_MODES)
    return await _settled(
        vehicle,
        order,
        vehicle.client.return_to_launch(),
        lambda state: back(state) or not state.armed,
        proves=back,
    )


async def _hold(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    armed = vehicle.client.state.armed
    modes = WAITING_MODES if armed else frozenset({"MANUAL", "GUIDED", "AUTO.LOITER"})
    return await _settled(vehicle, order, vehicle.client.hold(), _in(vehicle, modes))


async def _goto_item(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    assert wish.seq is not None
    client = vehicle.client
    count = await _items_held(vehicle, client)
    if count == 0:
        raise OrderRefusedError(
            "item-out-of-range", "not sent: there is no mission on board", "upload one, and send it then"
        )
    if count is not None and not 0 <= wish.seq < count:
        raise OrderRefusedError(
            "item-out-of-range",
            f"not sent: the mission on board has no item {wish.seq}, its items are 0 to {count - 1}",
            "send the number of an item of the mission",
        )
    order.sent = True
    outcome = await client.goto_item(wish.seq)
    if outcome.kind == "refused":
        raise OrderRefusedError("command-refused", str(outcome), "send the number of an item of the mission")
    if outcome.kind == "accepted":
        return "done", ""
    state = client.state
    if not state.connected:
        return "unknown", f"not acknowledged: {client.absence}"
    now = f"item {state.mission_current}" if count and state.mission_current is not None else "no item"
    return "unknown", f"not acknowledged: the vehicle is heard, and says that it flies to {now}"


async def _items_held(vehicle: Vehicle, client: VehicleClient) -> int | None:
    """How many items the mission on board has, the home row included; None where nobody can tell."""
    if client.state.mission_total is not None:
        return client.state.mission_total
    try:
        return len(await client.mission_held(anew=vehicle.held is None))
    except TransferFailedError:
        return None


async def _land(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    client = vehicle.client
    state = client.state
    # One that has fallen silent may fly, whatever was heard of it last.
    if not state.armed and state.connected:
        raise OrderRefusedError("not-flying", "the aircraft is not armed: it stands", "send nothing")
    if state.type not in ("fixed_wing", "other"):
        down = _in(vehicle, LANDING_MODES)
        return await _settled(
            vehicle, order, client.land_here(), lambda state: down(state) or not state.armed, proves=down
        )
    if not state.connected:
        raise OrderRefusedError(
            "vehicle-silent",
            "not sent: a fixed wing lands by its mission, which is not set going unheard",
            "send rtl: it is sent to a silent vehicle, too",
        )
    first = landing_of(await _mission_of(vehicle, client))
    if first is None:
        raise OrderRefusedError(
            "no-landing",
            "a fixed wing lands by its mission, and the one it holds has no landing",
            "send rtl or hold, and land it by hand; or plan with the finish 'land'",
        )
    order.sent = True
    outcome = await client.goto_item(first)
    if outcome.kind == "refused":
        raise OrderRefusedError("command-refused", str(outcome), "send rtl")
    if outcome.kind == "unknown":
        return "unknown", str(outcome)
    if client.state.mode in MISSION_MODES:
        return "done", f"on its way to the mission's landing, item {first}"
    shows = _in(vehicle, MISSION_MODES)
    words = f"on its way to the mission's landing, item {first}"
    return await _settled(vehicle, order, client.fly_on(), shows, words)


async def _mission_of(vehicle: Vehicle, client: VehicleClient) -> tuple[MissionItem, ...]:
    """The mission it holds: as read back last while nobody has changed it, else read now."""
    try:
        return await client.mission_held(anew=vehicle.held is None)
    except TransferFailedError as error:
        raise OrderRefusedError(
            "mission-unread", f"the mission's landing is not known: {error}", "send it again, or rtl"
        ) from error


async def _sensor_off(vehicle: Vehicle, wish: Wish, order: Order) -> Told:
    client = vehicle.client
    payload = (
        parse_payload(wish.payload) if wish.payload is not None else vehicle.safety.payload or DEFAULT_PAYLOAD
    )
    told, reason = await _settled(
        vehicle,
        order,
        client.switch_off(payload, unheard=True),
        lambda state: state.sensor_shown is not True,
        proves=lambda state: state.sensor_shown is False,
    )
    if told == "done" and client.state.sensor_shown is None:
        return "done", "the vehicle took it; nothing shows whether the sensor is off"
    return told, reason


Carry = Callable[[Vehicle, Wish, Order], Awaitable[Told]]
CARRY_OUT: Final[dict[str, Carry]] = {
    "arm": _arm,
    "disarm": _disarm,
    "start": _start,
    "pause": _pause,
    "resume": _resume,
    "rtl": _rtl,
    "hold": _hold,
    "land": _land,
    "goto_item": _goto_item,
    "sensor_off": _sensor_off,
}
