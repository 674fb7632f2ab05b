"""Explicit flight commands, each in the way the autopilot at hand understands it.

Source: MAVLink ``common.xml`` (MAV_CMD). ArduPlane has no pause: it loiters, and AUTO resumes at the current
item. ArduCopter pauses within AUTO (DO_PAUSE_CONTINUE). PX4 holds, and its mission mode resumes. ArduCopter's
LOITER follows the throttle stick, so that without a stick it sinks: BRAKE keeps place and height by itself.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

from mavlink.encoding.payload import Payload, off_items
from mavlink.state.modes import mode_parameters
from mavlink.state.outputs import switched_by
from mavlink.state.telemetry import VehicleState
from mavlink.transfer.command import CommandOutcome
from mavlink.transfer.outcome import Outcome
from mavlink.wire.items import Command


class FlightCommands(ABC):
    """The commands, on top of ``command`` and ``set_current``. None is ever repeated by itself."""

    @property
    @abstractmethod
    def state(self) -> VehicleState:
        """All that is known of the vehicle now."""

    @abstractmethod
    async def command(
        self, command: int, parameters: Sequence[float] = (), unheard: bool = False
    ) -> CommandOutcome:
        """Send a command until it is answered; ``unheard`` to a vehicle that has fallen silent, too."""

    @abstractmethod
    def require_certain(self) -> None:
        """Raise DoubtError unless the vehicle meant hears, and it alone."""

    @abstractmethod
    async def set_current(self, seq: int) -> Outcome:
        """Make an item the one flown next."""

    async def arm(self) -> CommandOutcome:
        """Arm the motors; the vehicle's own checks decide. Raises DoubtError."""
        self.require_certain()
        return await self.command(Command.COMPONENT_ARM_DISARM, (1.0,))

    async def disarm(self) -> CommandOutcome:
        """Disarm the motors; refused in flight."""
        return await self.command(Command.COMPONENT_ARM_DISARM, (0.0,))

    async def set_mode(self, name: str, unheard: bool = False) -> CommandOutcome:
        """Change the flight mode, named as in the state. Raises ValueError for a mode it has not."""
        parameters = mode_parameters(self.state.autopilot, self.state.type, name)
        return await self.command(Command.DO_SET_MODE, parameters, unheard)

    async def start_mission(self) -> CommandOutcome:
        """Take off and fly the mission, or in the air go on with it at its current item.

        PX4 arms by itself, and begins at the item named, which in the air is none (−1): at 0 it would turn
        back to its take-off. ArduPilot wants to be armed first. Raises DoubtError.
        """
        self.require_certain()
        if self.state.autopilot == "ardupilot":
            outcome = await self.set_mode("AUTO")
            if not outcome.accepted:
                return outcome
        in_air = self.state.autopilot == "px4" and self.state.armed and self.state.landed is not True
        return await self.command(Command.MISSION_START, (-1.0,) if in_air else ())

    async def pause(self) -> CommandOutcome:
        """Stop the mission and wait in the air."""
        if self.state.autopilot == "px4":
            return await self.set_mode("AUTO.LOITER")
        if self.state.autopilot == "ardupilot" and self.state.type != "multirotor":
            return await self.set_mode("LOITER")
        return await self.command(Command.DO_PAUSE_CONTINUE, (0.0,))

    async def fly_on(self) -> CommandOutcome:
        """Into the mission's mode from another one, at the current item; one that is disarmed stays so."""
        return await self.set_mode("AUTO.MISSION" if self.state.autopilot == "px4" else "AUTO")

    async def resume(self) -> CommandOutcome:
        """Go on with the mission at its current item. Raises DoubtError."""
        self.require_certain()
        if self.state.autopilot == "px4":
            return await self.set_mode("AUTO.MISSION")
        # What ArduCopter's AUTO goes on with is a pause within it; out of another mode it has to come back.
        if self.state.autopilot == "ardupilot" and (
            self.state.type != "multirotor" or self.state.mode != "AUTO"
        ):
            return await self.set_mode("AUTO")
        return await self.command(Command.DO_PAUSE_CONTINUE, (1.0,))

    async def hold(self) -> CommandOutcome:
        """Wait where it is; one that is disarmed goes into a mode that keeps it on the ground when armed.

        Sent unheard, too.
        """
        if self.state.autopilot == "px4":
            return await self.set_mode("AUTO.LOITER", unheard=True)
        if self.state.autopilot == "ardupilot":
            hovers = self.state.type == "multirotor"
            # One that has fallen silent may fly, whatever was heard of it last.
            if self.state.armed or not self.state.connected:
                return await self.set_mode("BRAKE" if hovers else "LOITER", unheard=True)
            return await self.set_mode("GUIDED" if hovers else "MANUAL", unheard=True)
        return await self.command(Command.DO_PAUSE_CONTINUE, (0.0,), unheard=True)

    async def land_here(self) -> CommandOutcome:
        """Come down where it is: for those that hover; wings land by their mission. Sent unheard, too."""
        if self.state.autopilot == "px4":
            return await self.set_mode("AUTO.LAND", unheard=True)
        if self.state.autopilot == "ardupilot":
            hovers = self.state.type == "multirotor"
            return await self.set_mode("LAND" if hovers else "QLAND", unheard=True)
        return await self.command(Command.NAV_LAND, unheard=True)

    async def switch_off(self, payload: Payload, unheard: bool = False) -> CommandOutcome:
        """Switch a payload off at once, whatever the mode. Raises PayloadError where it has no such."""
        worst: CommandOutcome | None = None
        for off in off_items(switched_by(payload, self.state.autopilot)):
            parameters = (off.param1, off.param2, off.param3, off.param4, float(off.x), float(off.y), off.z)
            answer = await self.command(off.command, parameters, unheard)
            worst = answer if worst is None or not answer.accepted else worst
        assert worst is not None
        return worst

    async def return_to_launch(self) -> CommandOutcome:
        """Break off and come back. Sent unheard, too."""
        return await self.command(Command.NAV_RETURN_TO_LAUNCH, unheard=True)

    async def goto_item(self, seq: int) -> Outcome:
        """Fly to an item of the mission next; unknown when the vehicle does not say that it will."""
        return await self.set_current(seq)
