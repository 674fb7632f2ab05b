"""Modes of the simulated aircraft: who steers, and when it may move at all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from mavlink.sim.acceptance import infeasible
from mavlink.sim.atmosphere import true_over_equivalent
from mavlink.sim.dynamics import AircraftState, FlightCommand
from mavlink.sim.executor import Do, Event, Landed, MissionRun, Said
from mavlink.sim.geodesy import Place
from mavlink.sim.kinds import craft_of
from mavlink.sim.manoeuvres import Manoeuvre
from mavlink.sim.modes import Flavour, Mode
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command, Frame, MissionItem

#: MAV_SEVERITY_INFO
_INFO = 6


class Pilot:
    """Turns mode, mission and state into a flight command.

    The aircraft leaves the ground only when it is armed, and in AUTO with a mission that begins with a
    take-off, or ordered to take off.

    Attributes
    ----------
    events
        What happened since the caller last emptied it.
    """

    def __init__(self, settings: SimSettings) -> None:
        self._settings = settings
        self._craft = craft_of(settings)
        self.home = settings.home
        self.armed = False
        self.mode = Mode.MANUAL if settings.autopilot is Flavour.ARDUPILOT else Mode.LOITER
        self.events: list[Event] = []
        self._items: tuple[MissionItem, ...] = ()
        self._run: MissionRun | None = None
        self._manoeuvre: Manoeuvre | None = None
        self._seq = self._first
        self._airspeed_m_s = settings.airspeed_m_s
        self._ground_speed_m_s: float | None = None
        self._waits = False
        self._lifting = False

    @property
    def _copter(self) -> bool:
        """Whether it is ArduCopter, which pauses, starts and ends its missions in ways of its own."""
        return self._settings.hovers and self._settings.autopilot is Flavour.ARDUPILOT

    @property
    def paused(self) -> bool:
        """Whether ArduCopter has paused its mission in AUTO."""
        return self.mode is Mode.AUTO and self._run is not None and self._manoeuvre is not None

    @property
    def _first(self) -> int:
        return 1 if self._settings.autopilot is Flavour.ARDUPILOT else 0

    @property
    def current(self) -> int:
        """Sequence number of the item being flown, or to be flown on a start."""
        return self._run.current if self._run is not None else self._seq

    @property
    def cross_track_m(self) -> float:
        """Distance to the right of the leg being flown."""
        return self._run.cross_track_m if self._run is not None else 0.0

    @property
    def mission_complete(self) -> bool:
        """Whether the mission has been flown to its end."""
        return self._run is None and bool(self._items) and self._seq >= len(self._items)

    def load(self, items: Sequence[MissionItem], state: AircraftState) -> None:
        """A new mission is stored; one being flown goes on at the same number, or ends if it is shorter."""
        self._items = tuple(items)
        if self.mode is Mode.AUTO and self._run is not None:
            seq = self._run.current
            self._run = None
            if seq < len(items) and not infeasible(
                self._settings.autopilot, items, hovers=self._settings.hovers
            ):
                self._fly_from(seq, state)
            else:
                self._mission_over(state)
            return
        self._seq = self._first
        self._run = None

    def select(self, seq: int, state: AircraftState) -> bool:
        """Make an item the current one; False when there is none of that number."""
        if not 0 <= seq < len(self._items):
            return False
        self._seq = max(seq, self._first)
        if self._run is not None:
            self._fly_from(self._seq, state)
        return True

    def arm(self) -> None:
        """Allow movement; a mission waiting in AUTO starts."""
        self.armed = True
        self._airspeed_m_s = self._settings.airspeed_m_s
        self._ground_speed_m_s = None

    def disarm(self) -> None:
        """Forbid movement; only on the ground."""
        self.armed = False
        self._run = self._manoeuvre = None

    def why_not_auto(self, state: AircraftState) -> str:
        """Why the mission cannot be flown; empty when it can."""
        reason = infeasible(self._settings.autopilot, self._items, hovers=self._settings.hovers)
        if reason:
            return reason
        run = MissionRun(self._items, self._settings, self._craft, self.home)
        first = run.first_navigation
        if state.on_ground and (first is None or first.command != Command.NAV_TAKEOFF):
            return "mission has no takeoff"
        return ""

    def set_mode(self, mode: Mode, state: AircraftState, goto: Place | None = None) -> None:
        """Change the mode; ``goto`` is where GUIDED leads; AUTO only when ``why_not_auto`` is empty."""
        if self._run is not None:
            self._seq = self._run.current
        self.mode = mode
        self._run = self._manoeuvre = None
        self._lifting = False
        if mode is Mode.AUTO and (state.on_ground or self._seq >= len(self._items)):
            # Whatever is left of an earlier flight, a start from the ground begins with the take-off.
            self._seq = self._first
        # ArduCopter in AUTO on the ground waits for the throttle or for MISSION_START.
        self._waits = mode is Mode.AUTO and state.on_ground and self._copter
        if state.on_ground:
            return
        if mode in (Mode.LOITER, Mode.BRAKE):
            self._manoeuvre = self._craft.wait(state)
        elif mode is Mode.RTL:
            self._manoeuvre = self._craft.come_home(state, self.home)
        elif mode is Mode.LAND:
            self._manoeuvre = self._craft.touch_down(state)
        elif mode is Mode.GUIDED:
            self._manoeuvre = self._craft.go(state, goto) if goto else self._craft.wait(state)

    def take_off(self, altitude_m: float, state: AircraftState) -> None:
        """Straight up, or along the run, to an altitude above sea level, and wait there; PX4 first arms."""
        self.set_mode(Mode.GUIDED if self._copter else Mode.TAKEOFF, state)
        item = MissionItem(0, Frame.GLOBAL, Command.NAV_TAKEOFF)
        self._manoeuvre = self._craft.takeoff(item, replace(state.place, altitude_m=altitude_m), state)
        self._lifting = True

    def retune(self, settings: SimSettings) -> None:
        """Fly by other settings from the next manoeuvre on."""
        self._settings, self._craft = settings, craft_of(settings)

    def start(self) -> None:
        """MISSION_START: what waits on the ground in AUTO waits no longer."""
        self._waits = False

    def pause(self, state: AircraftState, *, on: bool) -> bool:
        """Stop within the mission, or go on; False where there is no mission to pause."""
        if self.mode is not Mode.AUTO or self._run is None or state.on_ground:
            return False
        self._manoeuvre = (self._manoeuvre or self._craft.wait(state)) if on else None
        return True

    def change_speed(self, item: MissionItem) -> None:
        """DO_CHANGE_SPEED: param 1 says air (0) or ground (1) speed, param 2 how fast; -1 changes nothing."""
        if not item.param2 > 0.0 or (self._settings.hovers and item.param1 not in (0.0, 1.0)):
            # Multirotors have vertical speeds for 2 and 3.
            return
        if item.param1 == 1.0:
            self._ground_speed_m_s = item.param2
        else:
            self._airspeed_m_s, self._ground_speed_m_s = item.param2, None

    def command(self, state: AircraftState) -> FlightCommand:
        """What to do at this instant; nothing while disarmed."""
        if not self.armed:
            return FlightCommand()
        airspeed_m_s = self._wanted_airspeed_m_s(state)
        if self.mode is Mode.AUTO and self._manoeuvre is None:
            if self._waits:
                return FlightCommand()
            if self._run is None:
                self._fly_from(self._seq, state)
            if self._run is not None:
                command = self._run.command(state, airspeed_m_s)
                self._take_events(state)
                return command
        if self._manoeuvre is None:
            return FlightCommand(0.0, airspeed_m_s, 0.0)
        command = self._manoeuvre.command(state, airspeed_m_s)
        lifting, self._lifting = self._lifting, self._lifting and not self._manoeuvre.done
        if self._manoeuvre.done:
            if self._manoeuvre.lands:
                self._manoeuvre = None
                self.events.append(Landed())
            else:
                self._hold(state)
        # Only a take-off leaves the ground.
        return command if lifting or not state.on_ground else FlightCommand()

    def _hold(self, state: AircraftState) -> None:
        """Behind a take-off PX4 goes over to Hold; ArduCopter stays in GUIDED."""
        if self.mode is Mode.TAKEOFF:
            self.set_mode(Mode.LOITER, state)
        else:
            self._manoeuvre = self._craft.wait(state)

    def _fly_from(self, seq: int, state: AircraftState) -> None:
        self._run = MissionRun(self._items, self._settings, self._craft, self.home)
        self._run.begin(seq, state)
        self._take_events(state)

    def _take_events(self, state: AircraftState) -> None:
        run = self._run
        if run is None:
            return
        for event in run.events:
            if isinstance(event, Do) and event.item.command == Command.DO_CHANGE_SPEED:
                self.change_speed(event.item)
            self.events.append(event)
        run.events.clear()
        if run.returning:
            self.events.append(Said(_INFO, "Mission complete, returning"))
            self.set_mode(Mode.RTL, state)
            self._seq = len(self._items)
        elif run.finished:
            self._mission_over(state)

    def _mission_over(self, state: AircraftState) -> None:
        self._run = None
        self._seq = len(self._items)
        if state.on_ground:
            self.mode = Mode.MANUAL if self._settings.autopilot is Flavour.ARDUPILOT else Mode.LOITER
            return
        if self._copter:
            # It stays in AUTO, over the place where the mission has ended.
            self.events.append(Said(_INFO, "Mission complete, loitering"))
            self._manoeuvre = self._craft.wait(state)
        elif self._settings.autopilot is Flavour.ARDUPILOT:
            self.events.append(Said(_INFO, "Mission complete, changing mode to RTL"))
            self.set_mode(Mode.RTL, state)
        else:
            self.events.append(Said(_INFO, "Mission finished, loitering"))
            self.set_mode(Mode.LOITER, state)

    def _wanted_airspeed_m_s(self, state: AircraftState) -> float:
        if self._settings.hovers:
            # Both kinds of speed are its speed over the ground.
            return self._ground_speed_m_s or self._airspeed_m_s
        if self._ground_speed_m_s is None or state.on_ground:
            return self._airspeed_m_s
        along = math.atan2(state.east_m_s, state.north_m_s)
        tail_m_s = state.wind_north_m_s * math.cos(along) + state.wind_east_m_s * math.sin(along)
        return max(self._ground_speed_m_s - tail_m_s, 1.0) / true_over_equivalent(state.altitude_m)
