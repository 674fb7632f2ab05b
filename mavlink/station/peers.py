"""Who is believed on a listening port: the vehicle's address alone, once it is known.

Anybody may send a datagram. The first address from which the vehicle's autopilot is heard is the vehicle's;
all others are strangers, who are neither heard nor sent to, but told. No socket, no clock.

Source: https://mavlink.io/en/messages/common.html#HEARTBEAT
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

from mavlink.station.identity import is_autopilot
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from mavlink.wire.signing import Signing, Verdict

Address = tuple[Any, ...]

#: Strangers told at a time; one silent this long is told no more.
_MOST_STRANGERS: Final = 16
FORGET_AFTER_S: Final = 30.0
#: A stranger who says that it is the vehicle counts as such this long.
RIVAL_FOR_S: Final = 10.0


@dataclass(frozen=True, slots=True)
class Stranger:
    """An address that is not the vehicle's.

    Parameters
    ----------
    system_id
        The autopilot it said it is; None while it said none.
    claimed_s
        When it last said so, in the caller's clock.
    """

    address: str
    heard_s: float
    system_id: int | None = None
    claimed_s: float = 0.0


class Peers:
    """The senders heard on one port.

    Parameters
    ----------
    system_id
        The vehicle's; 0 takes the first autopilot heard.
    clock
        Seconds; only differences matter.
    changed
        Called when there is something new to tell.

    Attributes
    ----------
    address
        The vehicle's; None while it is not known.
    signing
        Verifies the frames of those that are not believed yet; None where nobody signs.
    acknowledged
        Somebody said that the vehicle is there: others who say that they are it are no matter.
    """

    def __init__(self, system_id: int, clock: Callable[[], float], changed: Callable[[], None]) -> None:
        self.address: Address | None = None
        self.acknowledged = False
        self._system_id = system_id
        self._clock = clock
        self._changed = changed
        self._lost = False
        self._strangers: dict[Address, Stranger] = {}
        self.signing: Signing | None = None
        self._behind: Address | None = None

    @property
    def answered(self) -> tuple[Address, ...]:
        """Where alone to send to.

        A vehicle whose clock is behind, at first or after a restart on another port, hears what time it is
        from there too, and is believed with the next frame.
        """
        return tuple(address for address in (self.address, self._behind) if address is not None)

    @property
    def place(self) -> str | None:
        """The vehicle's address in words."""
        return None if self.address is None else told(self.address)

    @property
    def strangers(self) -> tuple[Stranger, ...]:
        """Those heard lately, in the order they came."""
        return tuple(self._strangers.values())

    @property
    def rivals(self) -> tuple[Stranger, ...]:
        """Strangers who said lately that they are the vehicle."""
        now_s = self._clock()
        return tuple(
            stranger
            for stranger in self._strangers.values()
            if stranger.system_id == self._system_id and now_s < stranger.claimed_s + RIVAL_FOR_S
        )

    def sift(self, sender: Address, data: bytes) -> bytes:
        """What of a datagram is to be believed; nothing of a stranger's.

        The heartbeats of another aircraft are let through while the vehicle is silent: it may have been
        swapped, which is told and acknowledged by its system id.
        """
        if sender == self.address:
            return data
        frames: list[tuple[bytes, Message]] = []
        codec = Codec()
        codec.heard = lambda frame, message: None if message is None else frames.append((frame, message))
        codec.feed(data)
        claims = [(frame, message) for frame, message in frames if is_autopilot(message)]
        if self.signing is not None:
            verdicts = [(self.signing.check(frame), frame, message) for frame, message in claims]
            claims = [(frame, message) for verdict, frame, message in verdicts if verdict is Verdict.GENUINE]
            silent = self.address is None or self._lost
            if silent and any(verdict is Verdict.REPLAYED for verdict, _, _ in verdicts):
                self._behind = sender
            if not claims and silent:
                # Nothing of it counts; what its signature says is told, by whoever reads it.
                return b"".join(frame for _, frame, message in verdicts)
        mine = [message for _, message in claims if self._system_id in (0, message.system_id)]
        if mine and self._may_be_the_vehicle(sender):
            self._bind(sender, mine[0].system_id)
            return data
        self._note(sender, claims[0][1].system_id if claims else None)
        if self.address is not None and not self._lost:
            return b""
        return b"".join(frame for frame, message in claims if message.system_id != self._system_id)

    def _may_be_the_vehicle(self, sender: Address) -> bool:
        """At first whoever comes first; afterwards the same machine on another port, once all is silent.

        Whoever signs with the vehicle's key may have moved further.
        """
        if self.address is None:
            return True
        return self._lost and (self.signing is not None or sender[0] == self.address[0])

    def _bind(self, sender: Address, system_id: int) -> None:
        self._strangers.pop(sender, None)
        self.address, self._system_id, self._behind = sender, system_id, None
        self._lost = self.acknowledged = False
        self._changed()

    def _note(self, sender: Address, system_id: int | None) -> None:
        now_s = self._clock()
        known = self._strangers.get(sender)
        if known is None and len(self._strangers) >= _MOST_STRANGERS:
            idle = next((a for a, s in self._strangers.items() if s.system_id != self._system_id), None)
            if system_id != self._system_id or idle is None:
                return
            del self._strangers[idle]
        stranger = replace(known, heard_s=now_s) if known else Stranger(told(sender), now_s)
        if system_id is not None:
            stranger = replace(stranger, system_id=system_id, claimed_s=now_s)
        self._strangers[sender] = stranger
        rival = system_id == self._system_id
        if known is None or known.system_id != stranger.system_id or rival:
            self._changed()

    def lost(self) -> None:
        """The vehicle is silent: it may come back from another port of its machine."""
        self._lost = True

    def heard(self) -> None:
        """The vehicle is there."""
        self._lost, self._behind = False, None

    def adopt(self, system_id: int) -> None:
        """Another aircraft is the vehicle; its address is the one it is heard from next."""
        self.address, self._behind, self._system_id, self.acknowledged = None, None, system_id, False
        self._strangers.clear()
        self._changed()

    def acknowledge(self, address: str) -> bool:
        """Take an address heard lately for the vehicle's; False when it was not heard."""
        found = [sender for sender in self._strangers if told(sender) == address]
        if address == self.place and self.address is not None:
            found = [self.address]
        if not found:
            return False
        self._bind(found[0], self._system_id)
        self.acknowledged = True
        self._changed()
        return True

    def let_time_pass(self) -> None:
        """Forget strangers that are silent."""
        oldest_s = self._clock() - FORGET_AFTER_S
        silent = [sender for sender, stranger in self._strangers.items() if stranger.heard_s < oldest_s]
        for sender in silent:
            del self._strangers[sender]
        if silent:
            self._changed()


def told(address: Address) -> str:
    """Host and port, as addresses of links are written."""
    host = str(address[0])
    return f"[{host}]:{address[1]}" if ":" in host else f"{host}:{address[1]}"
