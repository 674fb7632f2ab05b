"""What a driver believes: whose address is the vehicle's, and with which key it speaks."""

from __future__ import annotations

from abc import abstractmethod

from mavlink.errors import NotConnectedError
from mavlink.state.telemetry import VehicleState
from mavlink.station.requirements import Requirements
from mavlink.wire.codec import Codec
from mavlink.wire.signing import Signing, Verdict


class Believing(Requirements):
    """The part of a driver that others may tell whom to believe."""

    _codec: Codec

    @abstractmethod
    def _change(self, state: VehicleState) -> None:
        """Take over a state that may be the same."""

    def acknowledge(self, address: str) -> None:
        """Take an address for the vehicle's, whoever else says that it is there.

        Raises
        ------
        NotConnectedError
            Nobody was heard from there lately.
        """
        if self._failure is not None or not self._trust.acknowledge(address):
            raise NotConnectedError(self._failure or f"nobody is heard from {address}")

    def _doubt(self) -> None:
        """Tell what is doubted now."""
        self._change(self._trust.told(self.state))

    @property
    def signing(self) -> Signing | None:
        """What signs and verifies; None where nothing is signed."""
        return self._codec.signing

    @property
    def said(self) -> Verdict | None:
        """What the signature of the vehicle's last heartbeat said; None where none was looked at lately."""
        return self._trust.said

    def sign(self, signing: Signing | None) -> None:
        """Sign and verify with this from now on; None: with nothing."""
        self._codec.signing = signing
        self._trust.verify(signing)
        self._doubt()
