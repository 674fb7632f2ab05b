"""Whether the sensor is on now, and since when: by its own report, else by the output that switches it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from mavlink.state.outputs import PhotoOutput, RelayOutput, SensorOutput, ServoOutput
from mavlink.state.telemetry import VehicleState, is_sensor_switch
from mavlink.wire.messages import Message

#: A photo shows that its camera is on, for so long in the vehicle's time; then nobody can tell.
PHOTO_SHOWS_S: Final = 2.5
#: What a relay, a servo or a sensor that repeats itself said so long ago tells no more (vehicle time):
#: unasked, a relay is told every two seconds.
TOLD_SHOWS_S: Final = 5.0


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
        self._output_s: float | None = None
        self._said: bool | None = None
        self._said_s: float | None = None
        self._repeats = False

    def watched(self, state: VehicleState, message: Message, now_s: float) -> VehicleState:
        """The state after one of the vehicle's messages, its own report taken in already."""
        on = None if self.output is None else self.output.reads(message)
        if isinstance(self.output, PhotoOutput):
            state = self._by_photo(state, taken=on is not None)
        elif on is not None:
            self._output_s = state.time_s
            if on != state.output_on:
                state = replace(state, output_on=on)
        if is_sensor_switch(message):
            self._repeats |= state.sensor_on == self._said
            self._said, self._said_s = state.sensor_on, state.time_s
        return self._dated(self._faded(state), now_s)

    def _faded(self, state: VehicleState) -> VehicleState:
        """What was told too long ago by what is told again and again counts no more."""
        self._output_s = state.time_s if self._output_s is None else self._output_s
        fades = isinstance(self.output, RelayOutput | ServoOutput)
        if fades and state.output_on is not None and _is_past(self._output_s, state.time_s):
            state = replace(state, output_on=None)
        silent = self._repeats and _is_past(self._said_s, state.time_s)
        return state if silent == state.sensor_silent else replace(state, sensor_silent=silent)

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
        self._shown = self._photo_s = self._output_s = self._said = self._said_s = None
        return replace(state, sensor_on=None, output_on=None, sensor_silent=False, sensor_since_s=None)

    def _dated(self, state: VehicleState, now_s: float) -> VehicleState:
        if state.sensor_shown == self._shown:
            return state
        self._shown = state.sensor_shown
        return replace(state, sensor_since_s=None if self._shown is None else now_s)


def _is_past(told_s: float | None, now_s: float | None) -> bool:
    """Whether what was told then tells no more; where there is no clock nobody can say so."""
    return told_s is not None and now_s is not None and abs(now_s - told_s) > TOLD_SHOWS_S
