"""Who the vehicle of a link is, and who answers in its place while it is silent.

A system id names an aircraft. When another one begins to answer where the vehicle was, somebody has swapped
them: it is not talked to until that is acknowledged, for it holds another mission, or none.

Source: https://mavlink.io/en/messages/common.html#HEARTBEAT
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from mavlink.state.modes import GROUND_STATION_TYPE, NO_AUTOPILOT
from mavlink.state.telemetry import VehicleState
from mavlink.wire.messages import Message

#: Of a link on which nobody speaks who could be the vehicle.
SILENT: Final = "no vehicle is connected"


class Identity:
    """The system that is talked to, and the other one heard while it is silent.

    Parameters
    ----------
    system_id
        The vehicle's; 0 takes the first autopilot heard.
    silence_s
        Another one that is silent this long is gone.
    """

    def __init__(self, system_id: int, silence_s: float) -> None:
        self._system_id = system_id
        self._silence_s = silence_s
        self._other_heard_s = -math.inf

    def speaks(self, message: Message, state: VehicleState) -> bool:
        """True for the autopilot's messages; its heartbeat makes the acquaintance, anew after a loss."""
        if state.connected:
            return (message.system_id, message.component_id) == (state.system_id, state.component_id)
        return is_autopilot(message) and self._expected(state) in (0, message.system_id)

    def watched(self, state: VehicleState, message: Message, now_s: float) -> VehicleState:
        """The state after a message that is not the vehicle's: another autopilot may answer in its place.

        Beside a vehicle that is there others may fly on the same link, and mean nothing.
        """
        if state.connected or not is_autopilot(message) or self._expected(state) in (0, message.system_id):
            return state
        if state.other_system not in (None, message.system_id):
            return state
        self._other_heard_s = now_s
        return state if state.other_system else replace(state, other_system=message.system_id)

    def waited(self, state: VehicleState, now_s: float) -> VehicleState:
        """The state after some time: another one that was heard may be gone."""
        if state.other_system is None or now_s < self._other_heard_s + self._silence_s:
            return state
        return replace(state, other_system=None)

    def absence(self, state: VehicleState) -> str:
        """Why a vehicle that is not connected cannot be talked to."""
        if state.other_system is None:
            return SILENT
        return (
            f"system {state.other_system} answers where system {self._expected(state)} did: another aircraft,"
            " to be acknowledged first"
        )

    def adopt(self, system_id: int) -> None:
        """Expect this one from now on."""
        self._system_id = system_id

    def _expected(self, state: VehicleState) -> int:
        return self._system_id or state.system_id


def is_autopilot(message: Message) -> bool:
    """Whether it is an autopilot's heartbeat."""
    return (
        message.name == "HEARTBEAT"
        and message.integer("autopilot") != NO_AUTOPILOT
        and message.integer("type") != GROUND_STATION_TYPE
    )
