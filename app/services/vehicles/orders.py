"""Explicit flight commands; nothing else arms or moves a vehicle."""

from __future__ import annotations

from typing import Final

import structlog

from app.services.errors import CommandRefusedError, ConflictError, LinkError, RefusedError
from app.services.vehicles.vehicle import Vehicle
from mavlink import errors as mavlink_errors
from mavlink.transfer.command import CommandOutcome
from mavlink.transfer.outcome import Outcome
from planner.errors import Finding

log = structlog.get_logger(__name__)

#: Orders that make a vehicle fly a mission, and so not while one is being changed.
FLYING_ORDERS: Final = frozenset({"arm", "start", "resume", "goto_item"})


async def give_order(vehicle: Vehicle, command: str, seq: int | None) -> CommandOutcome | Outcome:
    """Give an explicit flight command; raises CommandRefusedError when the vehicle says no."""
    vehicle.turns.require_orders(command)
    log.info("flight command", vehicle=vehicle.name, command=command, seq=seq)
    try:
        if command in FLYING_ORDERS:
            with vehicle.turns.ordering(command):
                outcome = await _order(vehicle, command, seq)
        else:
            outcome = await _order(vehicle, command, seq)
    except (mavlink_errors.NotConnectedError, mavlink_errors.LinkError) as error:
        raise LinkError(f"{vehicle.name}: {error}") from error
    except mavlink_errors.BusyError as error:
        raise ConflictError(f"{vehicle.name} is busy: {error}") from error
    if isinstance(outcome, CommandOutcome):
        if outcome.result is not None and not outcome.accepted:
            said = vehicle.state.texts[-1].text if vehicle.state.texts else ""
            raise CommandRefusedError(f"{vehicle.name} refused {outcome}{said and f'; it says: {said}'}")
    elif outcome.kind == "refused":
        raise CommandRefusedError(f"{vehicle.name}: {outcome}")
    return outcome


async def _order(vehicle: Vehicle, command: str, seq: int | None) -> CommandOutcome | Outcome:
    client = vehicle.client
    match command:
        case "arm":
            return await client.arm()
        case "disarm":
            return await client.disarm()
        case "start":
            return await client.start_mission()
        case "pause":
            return await client.pause()
        case "resume":
            return await client.resume()
        case "rtl":
            return await client.return_to_launch()
        case "goto_item" if seq is not None:
            return await client.goto_item(seq)
    message = f"{command} needs the number of an item in seq"
    raise RefusedError(message, (Finding("seq", "seq-missing", message, "send seq"),))
