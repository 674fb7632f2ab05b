"""Flight commands: given one by one, each told by what the vehicle shows and not by its answer alone."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import asdict

import structlog

from app.services.errors import (
    CommandOvertakenError,
    CommandRefusedError,
    CommandUnknownError,
    ConflictError,
    LinkError,
    RefusedError,
    ServiceError,
)
from app.services.vehicles.aboard import ASKED, NotAboardError, require_aboard
from app.services.vehicles.flight_orders import CARRY_OUT, OrderRefusedError, Wish
from app.services.vehicles.order_book import FLYING, SAFE, UNHEARD, Order
from app.services.vehicles.vehicle import Vehicle
from mavlink import errors as mavlink_errors
from mavlink.encoding.payload import PayloadError
from planner.errors import Finding

log = structlog.get_logger(__name__)

#: How long an answer is waited for where nobody says: longer than a vehicle is asked again.
WAIT_S = 10.0

_ERRORS: dict[str, Callable[..., ServiceError]] = {
    "refused": CommandRefusedError,
    "overtaken": CommandOvertakenError,
    "unknown": CommandUnknownError,
}


async def give_order(vehicle: Vehicle, wish: Wish, wait_s: float = WAIT_S) -> Order:
    """Give an explicit flight command; one that is not settled in time goes on, and is pending.

    Raises
    ------
    CommandRefusedError, CommandOvertakenError, CommandUnknownError
        It has not been carried out, or nobody can tell.
    LinkError
        The vehicle is not there: nothing was sent. Stops are sent to one that has only fallen silent.
    BusyError
        What is to be flown is being changed.
    RefusedError
        The wish itself is wrong.
    StorageError
        It cannot be recorded, and makes nothing safe: nothing was sent.
    """
    vehicle.turns.require_orders(wish.command)
    _judge(wish)
    if not vehicle.state.connected:
        _require_reachable(vehicle, wish)
    order = await _begun(vehicle, wish)
    log.info("flight command", vehicle=vehicle.name, command=wish.command, seq=wish.seq, command_id=order.id)
    task = asyncio.create_task(_follow(vehicle, wish, order))
    vehicle.book.follow(order, task)
    done, _ = await asyncio.wait((task,), timeout=wait_s)
    if done and not task.cancelled():
        task.result()
    if order.outcome in _ERRORS:
        members = {
            "vehicle_id": vehicle.id,
            "command_id": order.id,
            "command": order.command,
            "outcome": order.outcome,
            "reason": order.reason,
        }
        if order.unrecorded is not None:
            members["unrecorded"] = order.unrecorded
        detail = f"{vehicle.name}: {order.command} {order.outcome}: {order.reason}"
        raise _ERRORS[order.outcome](detail, order.findings, members)
    return order


async def _begun(vehicle: Vehicle, wish: Wish) -> Order:
    """The order in the book and in the audit; what makes safe stops others before anything is waited for."""
    what = {name: value for name, value in asdict(wish).items() if value is not None and value is not False}
    if wish.command in SAFE:
        order = vehicle.book.begin(wish.command)
        order.entry = await vehicle.audit.begin_safe("order", vehicle.id, vehicle.name, what)
        return order
    entry = await vehicle.audit.begin("order", vehicle.id, vehicle.name, what)
    order = vehicle.book.begin(wish.command)
    order.entry = entry
    return order


def _require_reachable(vehicle: Vehicle, wish: Wish) -> None:
    """Raise LinkError, but not of a stop for a vehicle that has only fallen silent."""
    if wish.command in UNHEARD:
        try:
            vehicle.client.require_reachable()
        except mavlink_errors.MavlinkError as error:
            raise LinkError(f"{vehicle.name}: {error}") from error
    else:
        raise LinkError(f"{vehicle.name}: {vehicle.client.absence}")


def _judge(wish: Wish) -> None:
    if wish.command == "goto_item" and wish.seq is None:
        message = "goto_item needs the number of an item in seq"
        raise RefusedError(message, (Finding("seq", "seq-missing", message, "send seq"),))
    if wish.as_held and wish.command not in ASKED:
        message = f"as_held says nothing to {wish.command}"
        fix = "send it with start or arm alone"
        raise RefusedError(message, (Finding("as_held", "option", message, fix),))
    for option, command in (("arm_first", "start"), ("hold_first", "arm")):
        if getattr(wish, option) and wish.command != command:
            message = f"{option} says nothing to {wish.command}"
            raise RefusedError(
                message, (Finding(option, "option", message, f"send it with {command} alone"),)
            )


def _require_certain(vehicle: Vehicle, wish: Wish) -> None:
    """Raise OrderRefusedError where it is doubted who would hear; stops are given all the same."""
    doubt = vehicle.state.doubt
    if doubt is not None and wish.command not in SAFE:
        raise OrderRefusedError(doubt.rule, doubt.message, doubt.fix)


async def _follow(vehicle: Vehicle, wish: Wish, order: Order) -> None:
    """Carry an order out to its end, and note that end."""
    flies = wish.command in FLYING
    try:
        _require_certain(vehicle, wish)
        with vehicle.turns.ordering(wish.command) if flies else nullcontext():
            if wish.command in ASKED and not wish.as_held:
                await require_aboard(vehicle)
            outcome, reason = await CARRY_OUT[wish.command](vehicle, wish, order)
        order.end(outcome, reason)
    except asyncio.CancelledError:
        # Overtaken, which is noted already; or the vehicle is let go.
        order.end("unknown", "given up before it was settled; it may have been carried out")
    except NotAboardError as error:
        order.end("refused", str(error), (Finding("command", error.rule, error.message, error.fix),))
    except OrderRefusedError as error:
        order.end("refused", str(error), (error.finding,))
    except PayloadError as error:
        order.end("refused", str(error))
        fix = "write e.g. relay:0, servo:9:1900:1100 or camera:distance=25"
        raise RefusedError(str(error), (Finding("payload", "payload", str(error), fix),)) from error
    except (mavlink_errors.NotConnectedError, mavlink_errors.LinkError) as error:
        if order.sent:
            order.end("unknown", f"{error}; it may have been carried out")
            return
        order.end("refused", str(error))
        raise LinkError(f"{vehicle.name}: {error}") from error
    except mavlink_errors.MavlinkError as error:
        order.end("refused", str(error))
        raise ConflictError(f"{vehicle.name}: {error}") from error
    except ServiceError as error:
        order.end("refused", str(error))
        raise
    finally:
        order.end("unknown", "it failed for a reason nobody foresaw")
        if order.entry is not None:
            vehicle.audit.end(order.entry, order.outcome, order.reason)
        log.info(
            "flight command ended",
            vehicle=vehicle.name,
            command=wish.command,
            command_id=order.id,
            outcome=order.outcome,
            reason=order.reason,
        )
        vehicle.tell()
