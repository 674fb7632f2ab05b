"""Forwarding of vehicles' links to other ground stations: what is asked for, and what is told of it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Final

import structlog

from app.services.errors import RefusedError
from mavlink.errors import AddressError
from mavlink.station.forward.address import FORMS, ForwardAddress, looped, parse_forward
from mavlink.station.forward.guard import CHANGES
from mavlink.station.forward.outlet import Outlet
from mavlink.wire.messages import Message
from planner.errors import Finding

log = structlog.get_logger(__name__)

MOST_FORWARDS: Final = 8

_ALL_TYPES: Final = 255
_ORDERS: Final = CHANGES | {"COMMAND_LONG", "COMMAND_INT", "SET_MODE", "PARAM_SET", "MISSION_SET_CURRENT"}
#: Stations ask for data all the time; that is no news. GET_HOME_POSITION, and 510 to 528, from
#: GET_MESSAGE_INTERVAL to the REQUEST_… commands.
_WISHES: Final = frozenset({410, *range(510, 529)})


def read_forwards(entries: Iterable[tuple[str, bool]], *, replay: bool = False) -> tuple[ForwardAddress, ...]:
    """Addresses from what a client wrote: address, and whether stations there may command the vehicle.

    Parameters
    ----------
    replay
        Whether the vehicle is a recording, which nobody can command.

    Raises
    ------
    RefusedError
        With a finding for each that is malformed, given twice or not possible.
    """
    addresses: list[ForwardAddress] = []
    findings = []
    for url, write in entries:
        try:
            address = parse_forward(url, write=write)
        except AddressError as error:
            findings.append(Finding("forward", "forward-address", str(error), f"write {FORMS}"))
            continue
        if address.url in {other.url for other in addresses}:
            message = f"{address.url} is given twice"
            findings.append(Finding("forward", "forward-twice", message, "give each address once"))
        elif write and replay:
            message = f"{address.url}: a recording takes no commands"
            findings.append(Finding("forward", "forward-write", message, "forward it to watch alone"))
        addresses.append(address)
    if len(addresses) > MOST_FORWARDS:
        message = f"{len(addresses)} addresses; {MOST_FORWARDS} are the most of one vehicle"
        findings.append(Finding("forward", "forward-many", message, "let a router distribute the rest"))
    if findings:
        raise RefusedError(f"the forwards are refused: {findings[0].message}", tuple(findings))
    return tuple(addresses)


def refuse_loops(urls: Sequence[str], forwards: Sequence[ForwardAddress]) -> None:
    """Raise RefusedError when two addresses of this service would talk to each other."""
    pair = looped(urls, forwards)
    if pair is not None:
        message = f"{pair[0]} and {pair[1]} are both of this service: frames would go round for ever"
        finding = Finding("forward", "forward-loop", message, "take another port")
        raise RefusedError(message, (finding,))


def tell_order(vehicle: str, outlet: Outlet, message: Message) -> None:
    """Log what another station orders the vehicle to do."""
    if message.name not in _ORDERS:
        return
    command = message.fields.get("command")
    if command in _WISHES:
        return
    log.info(
        "order of another ground station",
        vehicle=vehicle,
        forward=outlet.address.url,
        station=message.system_id,
        message=message.name,
        command=command,
    )


def tell_forwards(
    vehicle: str, addresses: Sequence[ForwardAddress], before: Collection[ForwardAddress]
) -> None:
    """Log where a vehicle's link is forwarded to since now."""
    for address in addresses:
        if address not in before:
            tell = log.warning if address.write else log.info
            tell("link forwarded", vehicle=vehicle, to=address.url, may_command=address.write)


def changes_mission(message: Message) -> bool:
    """Whether another station's frame changes the mission the vehicle holds."""
    return message.name in CHANGES and message.fields.get("mission_type", 0) in (0, _ALL_TYPES)
