"""Bodies of requests and answers about other ground stations that a link is forwarded to."""

from __future__ import annotations

from typing import Self

from pydantic import BaseModel, Field

from app.schemas.base import Strict
from app.services.vehicles.forwarding import MOST_FORWARDS
from app.services.vehicles.vehicle import Vehicle
from mavlink.station.forward.outlet import Outlet


class ForwardIn(Strict):
    """An address to forward a vehicle's link to, for another ground station."""

    url: str = Field(
        min_length=1,
        max_length=300,
        description="udpout:host:port, udpin:host:port, tcpin:host:port or tcp:host:port; without a host "
        "it is 127.0.0.1.",
        examples=["udpout:127.0.0.1:14550"],
    )
    write: bool = Field(
        default=False,
        description="Whether stations there may command the vehicle; else they only watch. While a mission "
        "is exchanged from here, what they send of the mission protocol is held back.",
    )


class ForwardFigures(BaseModel):
    """Frames counted since the address was first forwarded to."""

    sent: int = Field(description="From the vehicle to stations.")
    dropped: int = Field(description="Meant for a station that did not keep up; the oldest go first.")
    passed: int = Field(description="From stations on to the vehicle.")
    refused: int = Field(
        description="From stations that only watch, or meant for another vehicle; and orders while two "
        "aircraft may hear them under one system id."
    )
    held_back: int = Field(description="From stations while a mission was exchanged from here.")
    lost: int = Field(description="From stations: unreadable, or too many for the link to the vehicle.")


class ForwardOut(BaseModel):
    """An address a vehicle's link is forwarded to, and how it goes."""

    url: str
    address: str = Field(description="The same with the port really used.")
    write: bool = Field(description="Stations there may command the vehicle.")
    failure: str | None = Field(description="Why it is not open; it is tried again and again.")
    peers: int = Field(description="How many it is sent to; one that is called counts, there or not.")
    stations: list[int] = Field(description="System ids heard from there.")
    frames: ForwardFigures

    @classmethod
    def of(cls, outlet: Outlet) -> Self:
        """The answer for an address at work."""
        return cls(
            url=outlet.address.url,
            address=outlet.url,
            write=outlet.address.write,
            failure=outlet.failure,
            peers=outlet.peers,
            stations=outlet.stations,
            frames=ForwardFigures(**outlet.figures.as_dict()),
        )


class ForwardsIn(Strict):
    """Where to forward a vehicle's link to: these addresses and no others."""

    forward: list[ForwardIn] = Field(max_length=MOST_FORWARDS)


class ForwardsOut(BaseModel):
    """Where a vehicle's link is forwarded to."""

    vehicle_id: str
    forward: list[ForwardOut]
    shared: bool = Field(
        description="Another vehicle of the same system id is forwarded with `write` too: a station may not "
        "tell the two apart. What makes an aircraft fly or changes what it holds is refused to stations of "
        "both, until one has another system id or is forwarded to watch alone; stops pass."
    )

    @classmethod
    def of(cls, vehicle: Vehicle) -> Self:
        """The answer for a vehicle."""
        forward = [ForwardOut.of(outlet) for outlet in vehicle.forwards.outlets]
        return cls(vehicle_id=vehicle.id, forward=forward, shared=vehicle.forwards.shared)
