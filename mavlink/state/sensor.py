"""Whether the sensor is on now, and since when: by its own report, else by the output that switches it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from mavlink.state.outputs import PhotoOutput, SensorOutput
from mavlink.state.telemetry import VehicleState
from mavlink.wire.messages import Message

#: A photo shows that its camera is on, for so long in the vehicle's time; then nobody can tell.
PHOTO_SHOWS_S: Final = 2.5


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
        self._photo_s: float | None = None

    def watched(self, state: VehicleState, message: Message, now_s: float) -> VehicleState:
        """The state after one of the vehicle's messages, its own report taken in already."""
        on = None if self.output is None else self.output.reads(message)
        if isinstance(self.output, PhotoOutput):
            state = self._by_photo(state, taken=on is not None)
        elif on is not None and on != state.output_on:
            state = replace(state, output_on=on)
        return self._dated(state, now_s)

    def _by_photo(self, state: VehicleState, *, taken: bool) -> VehicleState:
        """A camera is on for a while from each photo on."""
        now_s = state.time_s or 0.0
        if taken:
            self._photo_s = now_s
        elif self._photo_s is not None and not 0.0 <= now_s - self._photo_s <= PHOTO_SHOWS_S:
            self._photo_s = None
        on = True if self._photo_s is not None else None
        return state if on == state.output_on else replace(state, output_on=on)

    def unknown(self, state: VehicleState) -> VehicleState:
        """The state when nobody can tell any more: the vehicle is silent, or another output counts."""
        self._shown = self._photo_s = None
        return replace(state, sensor_on=None, output_on=None, sensor_since_s=None)

    def _dated(self, state: VehicleState, now_s: float) -> VehicleState:
        if state.sensor_shown == self._shown:
            return state
        self._shown = state.sensor_shown
        return replace(state, sensor_since_s=None if self._shown is None else now_s)
