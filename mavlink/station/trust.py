"""Whether what is heard is the vehicle's, and orders reach it alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from mavlink.links.link import Link, OpenLink
from mavlink.state.telemetry import Doubt, VehicleState
from mavlink.station.peers import Peers
from mavlink.station.twins import Twins
from mavlink.wire.messages import Message


class Trust:
    """Who is believed on a link.

    Parameters
    ----------
    system_id
        The vehicle's; 0 takes the first autopilot heard.
    changed
        Called when ``told`` would say something else.
    """

    def __init__(
        self, link: Link, system_id: int, clock: Callable[[], float], changed: Callable[[], None]
    ) -> None:
        self._clock = clock
        self._twins = Twins()
        self._peers: Peers | None = None
        if isinstance(link, OpenLink) and link.listens:
            self._peers = Peers(system_id, clock, changed)
            link.believe(self._peers)

    def told(self, state: VehicleState) -> VehicleState:
        """The state with all that is doubted; the same object when nothing has changed."""
        strangers: tuple[str, ...] = ()
        address = None
        if self._peers is not None:
            strangers = tuple(stranger.address for stranger in self._peers.strangers)
            address = self._peers.place
        doubt = self._doubt(state)
        if (address, strangers, doubt) == (state.address, state.strangers, state.doubt):
            return state
        return replace(state, address=address, strangers=strangers, doubt=doubt)

    def _doubt(self, state: VehicleState) -> Doubt | None:
        if state.connected and self._twins.told(self._clock()):
            return Doubt(
                "two-aircraft",
                f"two aircraft speak in turns as system {state.system_id} on this link: what one is ordered,"
                " both do",
                "switch one of them off, or give it another system id",
            )
        peers = self._peers
        if peers is None or peers.acknowledged or not peers.rivals:
            return None
        others = ", ".join(stranger.address for stranger in peers.rivals)
        system_id = peers.rivals[0].system_id
        if state.connected:
            return Doubt(
                "two-aircraft",
                f"two aircraft say that they are system {system_id}: one at {peers.place}, which is heard, "
                f"and {others}, which is not",
                "give one of them another system id, or acknowledge the address of the one that is meant",
            )
        return Doubt(
            "another-address",
            f"system {system_id} speaks from {others} and not from {peers.place}, where it was",
            "acknowledge its address if it is the same aircraft",
        )

    @property
    def absence(self) -> str | None:
        """Why a vehicle that speaks from elsewhere is not heard; None where that is not so."""
        doubt = self._doubt(VehicleState())
        return None if doubt is None else f"{doubt.message}: {doubt.fix}"

    def acknowledge(self, address: str) -> bool:
        """Take an address heard lately for the vehicle's; False when it was not heard."""
        return self._peers is not None and self._peers.acknowledge(address)

    def heard(self, message: Message, now_s: float) -> None:
        """The vehicle, or another one under its ids, has spoken."""
        self._twins.heard(message, now_s)

    def connected(self) -> None:
        """The vehicle is there."""
        if self._peers is not None:
            self._peers.heard()

    def lost(self) -> None:
        """The vehicle has fallen silent."""
        if self._peers is not None:
            self._peers.lost()

    def adopt(self, system_id: int) -> None:
        """Another aircraft is the vehicle from now on."""
        self._twins = Twins()
        if self._peers is not None:
            self._peers.adopt(system_id)

    def let_time_pass(self) -> None:
        """Forget who is silent."""
        if self._peers is not None:
            self._peers.let_time_pass()
