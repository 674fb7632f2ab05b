"""Handing a vehicle its key, and having it sign no more: by explicit order alone.

There is no answer to SETUP_SIGNING: that the vehicle has taken the key is shown by the first heartbeat that
it signs with it. ArduPilot takes none while it is armed, and a new one only in a frame signed with the one it
has, but for its USB port, which it trusts; PX4 knows signing from 1.17 on.

Source: https://mavlink.io/en/guide/message_signing.html, ArduPilot ``GCS_Signing.cpp``,
https://docs.px4.io/main/en/mavlink/message_signing
"""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from typing import Final

from mavlink.errors import DoubtError, SigningError
from mavlink.state.telemetry import VehicleState
from mavlink.station.driver import Driver
from mavlink.wire.messages import Message
from mavlink.wire.signing import KEY_BYTES, Signing, Verdict

#: Some heartbeats' time.
SHOWN_WITHIN_S = 4.0
_LOOK_S: Final = 0.05
#: There is no answer, so that a lost one is not missed.
_COPIES: Final = 2


class SigningSetup(ABC):
    """The part of a client that changes who signs."""

    _driver: Driver

    @property
    @abstractmethod
    def state(self) -> VehicleState:
        """All that is known of the vehicle now."""

    @abstractmethod
    def _target(self) -> tuple[int, int]:
        """System and component to talk to. Raises NotConnectedError while there is none."""

    async def use_key(self, signing: Signing) -> None:
        """Sign and verify from now on with a key that the vehicle has already.

        Raises
        ------
        SigningError
            The vehicle is heard, and does not sign with it: nothing it says would count. All is as before.
        """
        before, heard = self._driver.signing, self.state.connected
        self._driver.sign(signing)
        if heard and not await self._shown(Verdict.GENUINE):
            said = self._driver.said
            self._driver.sign(before)
            raise SigningError(
                "the vehicle signs with another key than this one: give its key here"
                if said is Verdict.WRONG_KEY
                else "the vehicle does not sign with this key: hand it over first (set_up)"
            )

    async def set_up_signing(self, signing: Signing) -> None:
        """Hand the vehicle a key, and let nothing count from now on that is not signed with it.

        Raises
        ------
        SigningError
            The vehicle does not sign with it; all is as before.
        DoubtError, NotConnectedError
            Nothing was sent.
        """
        before = self._driver.signing
        self._say(signing.key.reveal(), signing.timestamp)
        self._driver.sign(signing)
        if not await self._shown(Verdict.GENUINE):
            said = self._driver.said
            self._driver.sign(before)
            raise SigningError(
                "the vehicle does not sign with the key"
                + (" but with another one" if said is Verdict.WRONG_KEY else "")
                + ": it was not taken. ArduPilot takes one while it is disarmed, and where it signs already"
                " only from whoever has its key, or by USB; PX4 from 1.17 on"
            )

    async def stop_signing(self) -> None:
        """Have the vehicle sign no more; then unsigned frames count again.

        Raises
        ------
        SigningError
            It goes on signing; all is as before.
        DoubtError, NotConnectedError
            Nothing was sent.
        """
        self._say(bytes(KEY_BYTES), 0)
        if not await self._shown(Verdict.UNSIGNED):
            raise SigningError("the vehicle goes on signing: ArduPilot stops while it is disarmed")
        self._driver.sign(None)

    def _say(self, secret: bytes, timestamp: int) -> None:
        system_id, component_id = self._target()
        doubt = self.state.doubt
        # One that signs with a key that is not known here may trust the link, as ArduPilot does its USB port.
        if doubt is not None and doubt.rule != "no-signing-key":
            raise DoubtError(doubt.rule, doubt.message, doubt.fix)
        if self.state.armed:
            raise SigningError("the vehicle is armed: keys are changed on the ground, disarmed")
        order = Message(
            "SETUP_SIGNING",
            {
                "target_system": system_id,
                "target_component": component_id,
                "secret_key": tuple(secret),
                "initial_timestamp": timestamp,
            },
        )
        self._driver.say([order] * _COPIES)

    async def _shown(self, verdict: Verdict) -> bool:
        """Whether the vehicle's heartbeats come to say this in time."""
        try:
            async with asyncio.timeout(SHOWN_WITHIN_S):
                while self._driver.said is not verdict:
                    await asyncio.sleep(_LOOK_S)
        except TimeoutError:
            return False
        return True
