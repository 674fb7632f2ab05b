"""Whether the sensor is on now, and since when: by its own report, else by the output that switches it."""

from __future__ import annotations

from dataclasses import replace

from mavlink.state.outputs import SensorOutput
from mavlink.state.telemetry import VehicleState
from mavlink.wire.messages import Message


class SensorWatch:
    """Folds what shows the sensor into a vehicle's state.

    Parameters
    ----------
    output
        What the payload in use switches; None where nothing shows it.
    """

    def __init__(self, output: SensorOutput | None = None) -> None:
        self.output = output
        self._shown: bool | None = None

    def watched(self, state: VehicleState, message: Message, now_s: float) -> VehicleState:
        """The state after one of the vehicle's messages, its own report taken in already."""
        on = None if self.output is None else self.output.reads(message)
        if on is not None and on != state.output_on:
            state = replace(state, output_on=on)
        return self._dated(state, now_s)

    def unknown(self, state: VehicleState) -> VehicleState:
        """The state when nobody can tell any more: the vehicle is silent, or another output counts."""
        self._shown = None
        return replace(state, sensor_on=None, output_on=None, sensor_since_s=None)

    def _dated(self, state: VehicleState, now_s: float) -> VehicleState:
        if state.sensor_shown == self._shown:
            return state
        self._shown = state.sensor_shown
        return replace(state, sensor_since_s=None if self._shown is None else now_s)
