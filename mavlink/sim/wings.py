"""A fixed wing's way of flying a mission's items."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from mavlink.sim.atmosphere import density_ratio
from mavlink.sim.craft import NAVIGATION, PLAIN, Path, Vertex
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.geodesy import Place
from mavlink.sim.guidance import PolylineFollower
from mavlink.sim.manoeuvres import GoTo, Landing, Loiter, Manoeuvre, Takeoff
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command, MissionItem


class FixedWing:
    """Manoeuvres of a fixed wing under ArduPlane or PX4."""

    navigation = NAVIGATION
    glides = True

    def __init__(self, settings: SimSettings) -> None:
        self._settings = settings
        self._tuning = settings.tuning
        self._ardupilot = settings.autopilot is Flavour.ARDUPILOT

    def flown_as(self, item: MissionItem) -> MissionItem:
        """PX4 takes off and lands by a VTOL's items; ArduPlane without rotors passes them over."""
        command = item.command if self._ardupilot else PLAIN.get(item.command, item.command)
        return replace(item, command=command)

    def path(self, start: Place, vertices: Sequence[Vertex]) -> Path:
        """A polyline whose corners are looked past."""
        return PolylineFollower(self._tuning, [start, *(vertex.place for vertex in vertices)])

    def acceptance_m(self, item: MissionItem) -> float:
        """The item's distance, which PX4's fixed wings do not look at, or the autopilot's own."""
        return (item.param2 if self._ardupilot else 0.0) or self._settings.acceptance_m

    def stop_s(self, item: MissionItem) -> float:
        """Never: it cannot stop."""
        return 0.0

    def stop(self, place: Place, seconds: float) -> Manoeuvre:
        """Circles, as never asked for."""
        return Loiter(self._tuning, place, self._settings.turn_radius_m, seconds=seconds)

    def takeoff(self, item: MissionItem, place: Place, state: AircraftState) -> Manoeuvre:
        """A run; ArduPlane climbs straight on, PX4 to the item's place."""
        named = place if item.x or item.y else None
        return Takeoff(
            self._tuning,
            state,
            place.altitude_m,
            self._settings.climb_m_s,
            radius_m=self._settings.turn_radius_m,
            towards=None if self._ardupilot else named,
            pointed_at=named if self._settings.heading_deg is None else None,
        )

    def land(self, start: Place, place: Place) -> Manoeuvre:
        """A glide, a flare and a run-out."""
        return Landing(
            self._tuning,
            start,
            place,
            ground_m=self._settings.home.altitude_m,
            sink_m_s=self._settings.sink_m_s,
            radius_m=self._settings.turn_radius_m,
        )

    def loiter(
        self, item: MissionItem, place: Place, state: AircraftState, onwards: Place | None
    ) -> Manoeuvre:
        """Circles of the item's radius, or of the default one."""
        radius_m = item.param2 if item.command == Command.NAV_LOITER_TO_ALT else item.param3
        # Written so that NaN, which PX4 takes, means the default too.
        if not abs(radius_m) > 1.0:
            radius_m = -self._settings.turn_radius_m if radius_m < 0.0 else self._settings.turn_radius_m
        aligned = item.param1 if item.command == Command.NAV_LOITER_TO_ALT else item.param2
        turns = item.param1 if item.command == Command.NAV_LOITER_TURNS else None
        seconds = item.param1 if item.command == Command.NAV_LOITER_TIME else None
        if self._ardupilot:
            # Source: ``AP_L1_Control::loiter_radius``, as long as the bank allows.
            radius_m /= density_ratio(place.altitude_m)
        return Loiter(
            self._tuning,
            place,
            radius_m,
            turns=turns,
            seconds=seconds,
            until_altitude=item.command == Command.NAV_LOITER_TO_ALT,
            # ArduPlane leaves every loiter towards the next item; PX4 where the item says so.
            exit_towards=onwards if self._ardupilot or aligned == 1.0 else None,
            by_circle=self._ardupilot,
        )

    def wait(self, state: AircraftState, place: Place | None = None) -> Manoeuvre:
        """Circles."""
        return Loiter(self._tuning, place or state.place, self._settings.turn_radius_m)

    def go(self, state: AircraftState, place: Place) -> Manoeuvre:
        """There, and circles."""
        return GoTo(self._tuning, state.place, place, self._settings.turn_radius_m)

    def come_home(self, state: AircraftState, home: Place) -> Manoeuvre:
        """ArduPlane goes home at its return altitude and circles; PX4 goes home and lands."""
        if not self._ardupilot:
            return self.land(state.place, home)
        above = replace(home, altitude_m=home.altitude_m + self._settings.rtl_altitude_m)
        return self.go(state, above)

    def touch_down(self, state: AircraftState) -> Manoeuvre:
        """Straight on and down."""
        return self.land(state.place, replace(state.place, altitude_m=self._settings.home.altitude_m))
