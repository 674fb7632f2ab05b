"""The one thing the service does to an aircraft unasked: it switches a sensor off that was left on."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from datetime import UTC, datetime

import structlog

from app.services.records import SensorAction
from app.services.vehicles.audit import SERVICE, Audit
from app.services.vehicles.recorder import FlightRecorder
from mavlink.encoding.payload import Payload
from mavlink.errors import BusyError, CodecError, LinkError, NotConnectedError, ReadOnlyError
from mavlink.state.outputs import SensorOutput
from mavlink.state.telemetry import VehicleState
from mavlink.station.client import VehicleClient
from mavlink.station.sensor_guard import SensorGuard
from mavlink.wire.items import MissionType

log = structlog.get_logger(__name__)


class SensorSafety:
    """Watches one vehicle's sensor over all of its links, and has it switched off outside the passes.

    Parameters
    ----------
    recorder
        Keeps what was done in the record of the flight.
    audit
        Keeps what was ordered.
    tell
        Called when something was done.

    Attributes
    ----------
    last
        What was done last; None while nothing was.
    """

    def __init__(
        self,
        vehicle_id: str,
        vehicle: str,
        recorder: FlightRecorder,
        audit: Audit,
        tell: Callable[[], None],
    ) -> None:
        self._vehicle_id = vehicle_id
        self._vehicle = vehicle
        self._recorder = recorder
        self._audit = audit
        self._tell = tell
        self._guard = SensorGuard()
        self.last: SensorAction | None = None

    @property
    def payload(self) -> Payload | None:
        """How the sensor is switched, as the last mission from here said it; None where none did."""
        return self._guard.payload

    def hold(self, payload: Payload, passes: Sequence[range], items: int) -> None:
        """The vehicle holds a mission from here."""
        self._guard.hold(payload, passes, items)

    async def output(self, client: VehicleClient, payload: Payload) -> SensorOutput | None:
        """Where the vehicle shows whether a payload is on; None where it does not, or could not be asked."""
        try:
            return await client.sensor_output(payload)
        except (BusyError, NotConnectedError) as error:
            log.warning("output of the payload not known", vehicle=self._vehicle, reason=str(error))
            return None

    def interrupt(self, reason: str) -> None:
        """A pass is broken off in a way that the vehicle does not show."""
        self._guard.interrupt(reason)

    def cut_pass(self, state: VehicleState) -> range | None:
        """The pass whose items are flown with the sensor off, as it was switched off in it; None else."""
        return None if state.sensor_shown else self._guard.pass_at(state.mission_current)

    def left_out(self, state: VehicleState) -> tuple[range, ...]:
        """Passes that lie between where it left its mission and where it goes on: they are not flown."""
        return self._guard.left_out(state.mission_current)

    @property
    def passes(self) -> tuple[range, ...]:
        """Those of the mission from here, by the numbers of their items."""
        return self._guard.passes

    def release(self) -> None:
        """Its mission is being replaced or cleared."""
        self._guard.release()

    async def watch(self, client: VehicleClient) -> None:
        """Follow a link to its end."""
        async with contextlib.aclosing(client.states()) as states:
            async for state in states:
                replaced = MissionType.MISSION in client.replaced
                reason = self._guard.look(state, client.now_s, replaced=replaced)
                if reason is not None:
                    await self._switch_off(client, reason)

    async def _switch_off(self, client: VehicleClient, reason: str) -> None:
        payload, state = self._guard.payload, client.state
        assert payload is not None
        log.warning("sensor left on, switching it off", vehicle=self._vehicle, reason=reason)
        what = {"command": "sensor_off", "reason": reason}
        entry = await self._audit.begin_safe("order", self._vehicle_id, self._vehicle, what, SERVICE)
        try:
            answer = await client.switch_off(payload)
            outcome = str(answer)
            told = "unknown" if answer.result is None else "done" if answer.accepted else "refused"
            self._audit.end(entry, told, outcome)
        except (NotConnectedError, ReadOnlyError, LinkError, CodecError) as error:
            outcome = f"not sent: {error}"
            self._audit.end(entry, "refused", outcome)
        done = SensorAction(
            at=datetime.now(UTC),
            time_s=state.time_s,
            action="sensor_off",
            reason=reason,
            outcome=outcome,
            lon_deg=state.lon_deg,
            lat_deg=state.lat_deg,
        )
        tell = log.error if self._guard.given_up else log.warning
        tell("sensor ordered off", vehicle=self._vehicle, outcome=outcome, given_up=self._guard.given_up)
        try:
            await self._recorder.act(done)
        except Exception as error:
            # The watch goes on: the sensor matters more than its record, which the log has too.
            log.error("not kept in the flight's record", vehicle=self._vehicle, exc_info=error)
        self.last = done
        self._tell()
