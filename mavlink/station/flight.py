"""Explicit flight commands, each in the way the autopilot at hand understands it.

Source: MAVLink ``common.xml`` (MAV_CMD). ArduPlane has no pause: it loiters, and AUTO resumes at the current
item. ArduCopter pauses within AUTO (DO_PAUSE_CONTINUE). PX4 holds, and its mission mode resumes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

from mavlink.state.modes import mode_parameters
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
    async def command(self, command: int, parameters: Sequence[float] = ()) -> CommandOutcome:
        """Send a command until it is answered."""

    @abstractmethod
    async def set_current(self, seq: int) -> Outcome:
        """Make an item the one flown next."""

    async def arm(self) -> CommandOutcome:
        """Arm the motors; the vehicle's own checks decide."""
        return await self.command(Command.COMPONENT_ARM_DISARM, (1.0,))

    async def disarm(self) -> CommandOutcome:
        """Disarm the motors; refused in flight."""
        return await self.command(Command.COMPONENT_ARM_DISARM, (0.0,))

    async def set_mode(self, name: str) -> CommandOutcome:
        """Change the flight mode, named as in the state. Raises ValueError for a mode it has not."""
        parameters = mode_parameters(self.state.autopilot, self.state.type, name)
        return await self.command(Command.DO_SET_MODE, parameters)

    async def start_mission(self) -> CommandOutcome:
        """Fly the mission from its current item. PX4 arms by itself; ArduPilot wants to be armed first."""
        if self.state.autopilot == "ardupilot":
            outcome = await self.set_mode("AUTO")
            if not outcome.accepted:
                return outcome
        return await self.command(Command.MISSION_START)

    async def pause(self) -> CommandOutcome:
        """Stop the mission and wait in the air."""
        if self.state.autopilot == "px4":
            return await self.set_mode("AUTO.LOITER")
        if self.state.autopilot == "ardupilot" and self.state.type != "multirotor":
            return await self.set_mode("LOITER")
        return await self.command(Command.DO_PAUSE_CONTINUE, (0.0,))

    async def resume(self) -> CommandOutcome:
        """Go on with the mission at its current item."""
        if self.state.autopilot == "px4":
            return await self.set_mode("AUTO.MISSION")
        if self.state.autopilot == "ardupilot" and self.state.type != "multirotor":
            return await self.set_mode("AUTO")
        return await self.command(Command.DO_PAUSE_CONTINUE, (1.0,))

    async def return_to_launch(self) -> CommandOutcome:
        """Break off and come back."""
        return await self.command(Command.NAV_RETURN_TO_LAUNCH)

    async def goto_item(self, seq: int) -> Outcome:
        """Fly to an item of the mission next; unknown when the vehicle does not say that it will."""
        return await self.set_current(seq)
