"""A ground station's side of one vehicle: connect, transfer, command, watch."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncGenerator, Callable, Mapping, Sequence
from dataclasses import replace
from types import TracebackType
from typing import Final, Self

from mavlink.encoding.payload import Payload
from mavlink.errors import NotConnectedError, TransferFailedError, VehicleNotFoundError
from mavlink.links.link import Link, ReplayLink
from mavlink.state.mount import ATTITUDE_HZ, GIMBAL_DEVICE_ATTITUDE_STATUS
from mavlink.state.outputs import (
    INTERVALS_HZ,
    SensorOutput,
    function_parameters,
    output_of,
    pulse_parameters,
    switched_by,
)
from mavlink.state.telemetry import VehicleState
from mavlink.state.track import TrackRecorder
from mavlink.station.driver import Driver
from mavlink.station.flight import FlightCommands
from mavlink.station.forward.hub import Forwards
from mavlink.station.signing_setup import SigningSetup
from mavlink.station.terrain import Heights, TerrainServer
from mavlink.station.transfers import MissionTransfers
from mavlink.transfer.command import CommandMachine, CommandOutcome
from mavlink.transfer.machine import DEFAULT_SETTINGS, Progress, TransferSettings
from mavlink.transfer.parameters import Parameter, ParameterListMachine, ParametersMachine
from mavlink.wire.codec import Codec
from mavlink.wire.items import Command
from mavlink.wire.signing import Signing

# Messages asked for at connection, and how often a second.
_INTERVALS_HZ: Final = {
    33: 4.0,  # GLOBAL_POSITION_INT
    30: 4.0,  # ATTITUDE
    74: 2.0,  # VFR_HUD
    42: 1.0,  # MISSION_CURRENT
    1: 1.0,  # SYS_STATUS
    24: 1.0,  # GPS_RAW_INT
    242: 0.2,  # HOME_POSITION
    245: 1.0,  # EXTENDED_SYS_STATE
    2: 1.0,  # SYSTEM_TIME: cameras tell their times since 1970
    376: 4.0,  # RELAY_STATUS: in no stream of ArduPilot's, sent only when asked for
}
_VERSION: Final = 148.0  # AUTOPILOT_VERSION
_MICROSECONDS: Final = 1e6
_PARAMETER_RETRIES: Final = 2
_PARAMETER_TIMEOUT_S: Final = 0.8


class VehicleClient(MissionTransfers, FlightCommands, SigningSetup):
    """One vehicle at the other end of a link.

    Parameters
    ----------
    link
        Closed with the client.
    system_id
        This ground station's.
    clock
        Seconds; only differences matter.
    settings
        How patient transfers and commands are.
    vehicle_system
        The system id to talk to; 0 takes the first autopilot heard.
    lost_after_s
        A vehicle silent this long counts as lost: what is under way ends as unknown.
    tap
        Called with every frame of the link, both ways, e.g. ``TlogWriter.write``.
    forwards
        Other ground stations that hear the vehicle too; stays open when the client is closed.
    signing
        Signs what is sent; nothing that is not signed with its key counts. None: nothing is signed.

    Notes
    -----
    One task does all reading and sending; it lives from ``connect`` to ``close``. The first heartbeat after a
    loss connects the vehicle again.
    """

    def __init__(
        self,
        link: Link,
        *,
        system_id: int = 255,
        clock: Callable[[], float] = time.monotonic,
        settings: TransferSettings = DEFAULT_SETTINGS,
        vehicle_system: int = 0,
        lost_after_s: float = 5.0,
        tap: Callable[[bytes], None] | None = None,
        forwards: Forwards | None = None,
        signing: Signing | None = None,
    ) -> None:
        codec = Codec(system_id)
        codec.tap = tap
        # A recording is read as it is: its times are past.
        codec.signing = None if isinstance(link, ReplayLink) else signing
        super().__init__()
        self._driver = Driver(
            link, codec, clock, self._ask_for_telemetry, vehicle_system, lost_after_s, forwards
        )
        self._settings = settings
        self._clock = clock
        self._watched_hz: dict[int, float] = {}
        self._terrain: TerrainServer | None = None

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    @property
    def state(self) -> VehicleState:
        """All that is known of the vehicle now."""
        return self._driver.state

    @property
    def failure(self) -> str | None:
        """Why the client has ended: its link failed, its recording is over, it was closed; None before."""
        return self._driver.failure

    @property
    def now_s(self) -> float:
        """The clock that times of the state are told in."""
        return self._clock()

    @property
    def silent_s(self) -> float:
        """How long nothing was heard of the vehicle; infinite before its first word."""
        return self._driver.silent_s

    @property
    def link_quality(self) -> float | None:
        """The share of the vehicle's frames that arrived in the last ten seconds; None where too few did."""
        return self._driver.quality.share(self._clock())

    async def connect(self, timeout_s: float = 10.0) -> VehicleState:
        """Send heartbeats, and wait for an autopilot's; may be called again after a failure.

        Raises
        ------
        VehicleNotFoundError
            None came in time. The client goes on listening until it is closed.
        NotConnectedError
            The link has failed.
        """
        self._driver.start()
        try:
            return await self.wait_for(lambda state: state.connected, timeout_s)
        except TimeoutError as error:
            raise VehicleNotFoundError(f"no autopilot's heartbeat within {timeout_s:g} s") from error

    async def wait_for(self, condition: Callable[[VehicleState], bool], timeout_s: float) -> VehicleState:
        """Wait until the state meets a condition. Raises TimeoutError, or NotConnectedError at the end."""
        with self._driver.watching() as changed:
            async with asyncio.timeout(timeout_s):
                while self._driver.failure is None or condition(self.state):
                    if condition(self.state):
                        return self.state
                    changed.clear()
                    await changed.wait()
        raise NotConnectedError(self._driver.failure or "the client is closed")

    async def states(self) -> AsyncGenerator[VehicleState, None]:
        """The state now and after every change, until the client ends; a slow reader skips to the newest."""
        with self._driver.watching() as changed:
            while True:
                changed.clear()
                yield self.state
                if self._driver.failure is not None:
                    return
                await changed.wait()

    async def sensor_output(self, payload: Payload) -> SensorOutput | None:
        """Where this vehicle shows whether a payload is on; None where it shows it nowhere.

        On PX4 parameters are read: they say which output an actuator is, and what its pulses mean.

        Raises
        ------
        BusyError, NotConnectedError
            Nothing was asked.
        """
        autopilot = self.state.autopilot
        payload = switched_by(payload, autopilot)
        values = await self._parameters_there(function_parameters(payload, autopilot))
        values |= await self._parameters_there(pulse_parameters(payload, autopilot, values))
        return output_of(payload, autopilot, values)

    def start_recording(self, output: SensorOutput | None = None, in_gimbal: bool = False) -> TrackRecorder:
        """A recorder fed with everything the vehicle sends from now on.

        Parameters
        ----------
        output
            What switches the sensor, as ``sensor_output`` tells; the vehicle is asked to report it.
        in_gimbal
            Whether a gimbal holds the sensor; the vehicle is asked to report where it points.
        """
        recorder = TrackRecorder(output, self._driver.recording_clock, in_gimbal)
        self._driver.record(recorder)
        self._report(output)
        if in_gimbal:
            self._watch({GIMBAL_DEVICE_ATTITUDE_STATUS: ATTITUDE_HZ})
        return recorder

    def show_sensor(self, output: SensorOutput | None) -> None:
        """Let the state tell from this output whether the sensor is on; the vehicle is asked to report it."""
        self._driver.show_sensor(output)
        self._report(output)

    def _report(self, output: SensorOutput | None) -> None:
        if output is not None:
            self._watch(INTERVALS_HZ[type(output)])

    def _watch(self, wanted_hz: Mapping[int, float]) -> None:
        self._watched_hz |= wanted_hz
        if self.state.connected:
            self._ask_for(wanted_hz)

    def stop_recording(self, recorder: TrackRecorder) -> None:
        """Stop feeding a recorder; its track stays."""
        self._driver.stop_recording(recorder)

    def serve_terrain(self, heights: Heights) -> None:
        """Answer the vehicle's requests for the ground's heights; on recordings nothing is said."""
        if not self._driver.read_only and self._terrain is None:
            self._terrain = TerrainServer(heights, self._driver.say)
            self._driver.record(self._terrain)

    async def command(
        self, command: int, parameters: Sequence[float] = (), unheard: bool = False
    ) -> CommandOutcome:
        """Send a command (COMMAND_LONG) until it is answered. Raises NotConnectedError, CodecError.

        ``unheard`` sends it to a vehicle that has fallen silent, too: it may hear what it does not answer.
        """
        target = (self.state.system_id, self.state.component_id) if unheard else self._target()
        return await self._driver.command(
            CommandMachine(command, parameters, *target, self._settings), unheard
        )

    async def read_parameters(self, names: Sequence[str]) -> dict[str, Parameter]:
        """Read parameters by name; names the vehicle does not answer to are left out.

        Raises
        ------
        TransferFailedError
            None was answered.
        BusyError, NotConnectedError, ValueError
            Nothing was asked.
        """
        machine = ParametersMachine(names, *self._target(), self._bytewise, self._parameter_settings())
        outcome = await self._driver.transfer(machine)
        if outcome.kind != "accepted":
            raise TransferFailedError("reading parameters", outcome)
        return {name: machine.values[name] for name in machine.names if name in machine.values}

    async def _parameters_there(self, names: Sequence[str]) -> dict[str, float]:
        """Values of those the vehicle has."""
        if not names:
            return {}
        try:
            found = await self.read_parameters(names)
        except TransferFailedError:
            return {}
        return {name: parameter.value for name, parameter in found.items()}

    async def list_parameters(
        self, progress: Callable[[Progress], None] | None = None
    ) -> dict[str, Parameter]:
        """Read all parameters. Raises TransferFailedError, BusyError, NotConnectedError."""
        machine = ParameterListMachine(*self._target(), self._bytewise, self._settings)
        outcome = await self._driver.transfer(machine, progress)
        if outcome.kind != "accepted":
            raise TransferFailedError("reading all parameters", outcome)
        return machine.values

    async def close(self) -> None:
        """End the task, fail whoever waits, close the link; closing twice is harmless."""
        if self._terrain is not None:
            self._terrain.close()
        await self._driver.close()
        if self._driver.signing is not None:
            self._driver.signing.close()

    @property
    def _bytewise(self) -> bool:
        return self.state.autopilot == "px4"

    def _parameter_settings(self) -> TransferSettings:
        """Fewer retries than for missions: a name the vehicle does not know stays silent every time."""
        return replace(
            self._settings,
            retries=min(self._settings.retries, _PARAMETER_RETRIES),
            timeout_s=min(self._settings.timeout_s, _PARAMETER_TIMEOUT_S),
        )

    def require_reachable(self) -> None:
        """Raise NotConnectedError unless the vehicle is there, or was and has fallen silent."""
        self._driver.require_reachable()

    def require_certain(self) -> None:
        """Raise DoubtError unless the vehicle meant hears, and it alone; NotConnectedError without one."""
        self._driver.require_certain()

    def _target(self) -> tuple[int, int]:
        self._driver.require_connected()
        return self.state.system_id, self.state.component_id

    def _ask_for_telemetry(self) -> None:
        """Ask for what the state is made of; a vehicle that knows no intervals just says so."""
        self._ask_for(_INTERVALS_HZ | self._watched_hz)
        if not self._driver.read_only:
            # Once is enough: the version comes with the next start.
            asked = CommandMachine(Command.REQUEST_MESSAGE, (_VERSION,), *self._target(), self._settings)
            self._driver.post(asked)

    def _ask_for(self, rates_hz: Mapping[int, float]) -> None:
        if self._driver.read_only:
            return
        for message_id, rate_hz in rates_hz.items():
            parameters = (float(message_id), _MICROSECONDS / rate_hz)
            self._driver.post(
                CommandMachine(Command.SET_MESSAGE_INTERVAL, parameters, *self._target(), self._settings)
            )
