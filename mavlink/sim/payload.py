"""Payload outputs of the simulated aircraft: relays, servos, camera trigger, and the sensor they switch.

Source: MAVLink ``common.xml`` (DO_SET_RELAY, DO_SET_SERVO, DO_SET_ACTUATOR, DO_SET_CAM_TRIGG_DIST,
IMAGE_START_CAPTURE, SERVO_OUTPUT_RAW, CAMERA_CAPTURE_STATUS).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from mavlink.sim.dynamics import AircraftState
from mavlink.sim.faults import Fault
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.sim.shutter import Shutter
from mavlink.wire.items import Command
from mavlink.wire.messages import Message

_SERVO_ON_US = 1500.0
_RELAYS = 16
_RELAYS_PRESENT = (1 << _RELAYS) - 1
_OUTPUTS, _OUTPUTS_A_PORT = 32, 16
#: PX4's actuators 1 to 4 are outputs 5 to 8, as the parameters PWM_MAIN_FUNC5 to 8 say.
_FIRST_ACTUATOR_OUTPUT, _ACTUATORS = 5, 4
_PX4_MIDDLE_US, _PX4_HALF_US = 1500.0, 500.0
#: The switching-on that the fault ``sensor_skips`` swallows.
_SKIPPED = 2
SENSOR_NAME = "SAR_ON"

Params = tuple[float, float, float, float]


class Payload:
    """What the sensor does, and the messages that say so.

    Attributes
    ----------
    sensor_on
        Whether the sensor is on.
    """

    def __init__(self, settings: SimSettings, faults: frozenset[Fault]) -> None:
        self._settings = settings
        self._dead = Fault.SENSOR_DEAD in faults
        self._skips = Fault.SENSOR_SKIPS in faults
        self._switched_on = 0
        self._ordered_on = False
        self.sensor_on = False
        self._pulses_us = [0] * _OUTPUTS
        if settings.autopilot is Flavour.PX4:
            self._actuators((-1.0,) * _ACTUATORS)
        self._relays = 0
        self.shutter = Shutter(settings, faults)
        self.shutter.broken = self._failed

    @property
    def photos(self) -> int:
        """Photos taken so far."""
        return self.shutter.taken

    def handle(self, command: int, params: Params, state: AircraftState) -> list[Message] | None:
        """Carry out a payload command; None when it is none, or names an output that is not there.

        Parameters
        ----------
        params
            The command's first four parameters.
        """
        p1, p2, p3, _ = params
        settings = self._settings
        answers: list[Message] = []
        match command:
            case Command.DO_SET_RELAY:
                if not 0.0 <= p1 < _RELAYS:
                    return None
                bit = 1 << int(p1)
                self._relays = self._relays | bit if p2 else self._relays & ~bit
                answers += self.reports("RELAY_STATUS", state)
                if settings.sensor_relay in (None, int(p1)):
                    answers += self._switch(p2 != 0.0, state)
            case Command.DO_SET_SERVO:
                if not 1.0 <= p1 <= _OUTPUTS:
                    return None
                self._pulses_us[int(p1) - 1] = round(min(max(p2, 0.0), 65535.0))
                if settings.sensor_servo in (None, int(p1)):
                    answers += self._switch(p2 > _SERVO_ON_US, state)
            case Command.DO_SET_ACTUATOR:
                self._actuators(params)
                value = params[settings.sensor_actuator - 1] if settings.sensor_actuator <= 4 else math.nan
                if not math.isnan(value):
                    answers += self._switch(value > 0.0, state)
            case Command.DO_SET_CAM_TRIGG_DIST:
                answers += self._switch(p1 > 0.0, state)
                answers += self.shutter.by_distance(p1, state, at_once=p3 == 1.0)
            case Command.DO_SET_CAM_TRIGG_INTERVAL:
                # Milliseconds, unlike IMAGE_START_CAPTURE's seconds.
                answers += self._switch(p1 > 0.0, state)
                answers += self._run(max(p1, 0.0) / 1000.0, None, state)
            case Command.IMAGE_START_CAPTURE if p3 == 1.0 or not (p2 > 0.0 or p3 > 0.0):
                answers += self.shutter.release(state)
            case Command.IMAGE_START_CAPTURE:
                answers += self._switch(True, state)
                answers += self._run(max(p2, 0.0), int(p3) if p3 > 0.0 else None, state)
            case Command.IMAGE_STOP_CAPTURE:
                self.shutter.stop()
                answers += self._switch(False, state)
            case Command.VIDEO_START_CAPTURE:
                answers += self._switch(True, state)
                self.shutter.video_since_s = state.time_s if self.sensor_on else None
            case Command.VIDEO_STOP_CAPTURE:
                self.shutter.video_since_s = None
                answers += self._switch(False, state)
            case Command.DO_DIGICAM_CONTROL:
                answers += self.shutter.release(state)
            case Command.DO_TRIGGER_CONTROL:
                answers += self._switch(p1 == 1.0, state)
            case settings.sensor_command:
                answers += self._switch(p1 != 0.0, state)
            case _:
                return None
        return answers

    def step(self, state: AircraftState) -> list[Message]:
        """Photos due by distance or time; a counted run has ended with its last."""
        running = self.shutter.interval_s > 0.0
        told = self.shutter.step(state)
        if running and self.shutter.interval_s == 0.0:
            told += self._switch(False, state)
        return told

    def rest(self, state: AircraftState) -> list[Message]:
        """The mission is left."""
        if self.shutter.rest():
            return self._switch(False, state)
        return []

    def _run(self, interval_s: float, count: int | None, state: AircraftState) -> list[Message]:
        if interval_s <= 0.0:
            self.shutter.stop()
            return []
        told = self.shutter.by_time(interval_s, count, state)
        return told if self.shutter.interval_s > 0.0 else told + self._switch(False, state)

    def reports(self, name: str, state: AircraftState) -> list[Message]:
        """Messages of a name that tell of the payload now; none for other names."""
        match name:
            case "NAMED_VALUE_INT" if self._settings.sensor_reports:
                return [self._sensor_report(state)]
            case "RELAY_STATUS" if self._settings.autopilot is Flavour.ARDUPILOT:
                return [self._relay_status(state)]
            case "SERVO_OUTPUT_RAW":
                # The second port is told of once one of its outputs is in use.
                ports = (0, 1) if any(self._pulses_us[_OUTPUTS_A_PORT:]) else (0,)
                return [self._servo_output(state, port) for port in ports]
            case "CAMERA_CAPTURE_STATUS":
                return [self._capture_status(state)]
        return []

    def _sensor_report(self, state: AircraftState) -> Message:
        return Message(
            "NAMED_VALUE_INT",
            {"time_boot_ms": _ms(state), "name": SENSOR_NAME, "value": int(self.sensor_on)},
        )

    def _relay_status(self, state: AircraftState) -> Message:
        return Message(
            "RELAY_STATUS", {"time_boot_ms": _ms(state), "on": self._relays, "present": _RELAYS_PRESENT}
        )

    def _servo_output(self, state: AircraftState, port: int) -> Message:
        first = port * _OUTPUTS_A_PORT
        pulses_us = self._pulses_us[first : first + _OUTPUTS_A_PORT]
        fields = {f"servo{number}_raw": pulse_us for number, pulse_us in enumerate(pulses_us, start=1)}
        return Message(
            "SERVO_OUTPUT_RAW", {"time_usec": round(state.time_s * 1e6) & 0xFFFFFFFF, "port": port} | fields
        )

    def _capture_status(self, state: AircraftState) -> Message:
        # ArduPilot tells of no video.
        since_s = self.shutter.video_since_s or 0.0
        px4 = self._settings.autopilot is Flavour.PX4
        tells_video = self.shutter.video_since_s is not None and px4
        return Message(
            "CAMERA_CAPTURE_STATUS",
            {
                "time_boot_ms": _ms(state),
                "image_status": 2 if self.shutter.interval_s > 0.0 else 0,
                "video_status": int(tells_video),
                "image_interval": self.shutter.interval_s,
                "recording_time_ms": round(1000.0 * (state.time_s - since_s)) if tells_video else 0,
                "available_capacity": 0.0,
                "image_count": self.photos,
            },
        )

    def _actuators(self, values: Sequence[float]) -> None:
        """Values from -1 to 1 as pulses; NaN leaves an actuator as it is."""
        for number, value in enumerate(values[:_ACTUATORS]):
            if not math.isnan(value):
                pulse_us = _PX4_MIDDLE_US + _PX4_HALF_US * min(max(value, -1.0), 1.0)
                self._pulses_us[_FIRST_ACTUATOR_OUTPUT - 1 + number] = round(pulse_us)

    def _switch(self, on: bool, state: AircraftState) -> list[Message]:
        if on and not self._ordered_on:
            self._switched_on += 1
        self._ordered_on = on
        self.shutter.broken = self._failed
        on = on and not self._failed
        if on == self.sensor_on:
            return []
        self.sensor_on = on
        return self.reports("NAMED_VALUE_INT", state)

    @property
    def _failed(self) -> bool:
        return self._dead or (self._skips and self._switched_on == _SKIPPED)


def _ms(state: AircraftState) -> int:
    return round(state.time_s * 1000.0)
