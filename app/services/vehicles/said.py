"""Why a vehicle said no: its answer's code, how it stands, and what it said meanwhile of the same matter."""

from __future__ import annotations

import re
from typing import Final

from mavlink.state.telemetry import VehicleState
from mavlink.transfer.command import CommandOutcome
from mavlink.wire.items import Command

#: A text that explains an answer comes with it, or right behind it.
EXPLAINED_S: Final = 0.5

_ARM: Final = r"arm|pre-?flight|safety|motor"
_MISSION: Final = r"mission|item|waypoint|\bwp\b|take-?off"
_MODE: Final = r"mode|navigat|position|\bgps\b|\bekf\b|home"
#: Words of the texts that are of a command's matter.
_MATTERS: Final[dict[int, str]] = {
    Command.COMPONENT_ARM_DISARM: _ARM,
    Command.DO_SET_MODE: f"{_MODE}|{_MISSION}",
    Command.MISSION_START: f"{_MISSION}|{_MODE}|{_ARM}",
    Command.DO_PAUSE_CONTINUE: f"pause|continue|hold|{_MODE}|{_MISSION}",
    Command.NAV_RETURN_TO_LAUNCH: f"rtl|return|rally|{_MODE}",
    Command.NAV_LAND: f"land|{_MODE}",
    Command.DO_SET_RELAY: "relay",
    Command.DO_SET_SERVO: "servo|output",
    Command.DO_SET_ACTUATOR: "actuator|servo|output",
    Command.DO_SET_CAM_TRIGG_DIST: "camera|trigger|shutter|photo",
    Command.IMAGE_STOP_CAPTURE: "camera|capture|photo|image",
}


def said_of(state: VehicleState, command: int, begun_s: float) -> tuple[str, ...]:
    """What the vehicle said since a command was sent that is of its matter, each text once."""
    matter = _MATTERS.get(command)
    if matter is None:
        return ()
    words = re.compile(matter, re.IGNORECASE)
    texts = [text.text for text in state.texts if text.heard_s >= begun_s and words.search(text.text)]
    return tuple(dict.fromkeys(texts))


def standing(state: VehicleState) -> str:
    """How it stands, as far as that has a say in what it does."""
    where = {True: ", on the ground", False: ", in the air", None: ""}[state.landed]
    mode = f", in mode {state.mode}" if state.mode else ""
    return f"it is {'armed' if state.armed else 'disarmed'}{where}{mode}"


def refusal(state: VehicleState, outcome: CommandOutcome, begun_s: float) -> str:
    """The whole sentence."""
    said = said_of(state, outcome.command, begun_s)
    words = f"; it says: {'; '.join(said)}" if said else ""
    return f"the vehicle refused {outcome}; {standing(state)}{words}"
