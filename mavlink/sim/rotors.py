"""A multirotor's way of flying a mission's items: ArduCopter's or PX4's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from mavlink.sim.craft import NAVIGATION, PLAIN, Path, Vertex
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.geodesy import Place
from mavlink.sim.hovering import Circle, Descent, Return, Rise, Stay, stopping_place
from mavlink.sim.legs import Agility, LegFollower
from mavlink.sim.manoeuvres import Manoeuvre
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command, MissionItem

#: WPNAV_ACCEL of ArduCopter, MPC_ACC_HOR of PX4.
_ACCELERATION_M_S2 = {Flavour.ARDUPILOT: 2.5, Flavour.PX4: 3.0}
#: LAND_ALT_LOW and LAND_SPEED of ArduCopter, MPC_LAND_ALT2 and MPC_LAND_SPEED of PX4.
_SLOW_BELOW_M = {Flavour.ARDUPILOT: 10.0, Flavour.PX4: 5.0}
_SLOW_M_S = {Flavour.ARDUPILOT: 0.5, Flavour.PX4: 0.7}

_PLAIN: dict[int, int] = {**PLAIN, Command.NAV_SPLINE_WAYPOINT: Command.NAV_WAYPOINT}


class Multirotor:
    """Manoeuvres of a multirotor under ArduCopter or PX4."""

    navigation = NAVIGATION | {Command.NAV_DELAY}
    glides = False

    def __init__(self, settings: SimSettings) -> None:
        self._settings = settings
        flavour = settings.autopilot
        self._px4 = flavour is Flavour.PX4
        self._agility = Agility(
            speed_m_s=settings.airspeed_m_s,
            acceleration_m_s2=_ACCELERATION_M_S2[flavour],
            climb_m_s=settings.climb_m_s,
            sink_m_s=settings.sink_m_s,
            reached_abeam=not self._px4,
        )
        self._slow_below_m = _SLOW_BELOW_M[flavour]
        self._slow_m_s = _SLOW_M_S[flavour]

    def flown_as(self, item: MissionItem) -> MissionItem:
        """A VTOL's items as plain ones; the curve of splines is not simulated."""
        return replace(item, command=_PLAIN.get(item.command, item.command))

    def path(self, start: Place, vertices: Sequence[Vertex]) -> Path:
        """Straight legs, corners rounded as the autopilot does."""
        places = [start, *(vertex.place for vertex in vertices)]
        radii_m = [0.0, *(vertex.acceptance_m for vertex in vertices)]
        return LegFollower(self._agility, places, radii_m)

    def acceptance_m(self, item: MissionItem) -> float:
        """PX4 heeds the item's radius on multirotors; ArduCopter stores none."""
        named = item.param2 if self._px4 and item.command == Command.NAV_WAYPOINT else 0.0
        return named if named > 0.0 else self._settings.waypoint_radius_m

    def stop_s(self, item: MissionItem) -> float:
        """Param 1 of a waypoint."""
        return max(item.param1, 0.0) if item.command == Command.NAV_WAYPOINT else 0.0

    def stop(self, place: Place, seconds: float) -> Manoeuvre:
        """Stays there; the time counts from the arrival."""
        return Stay(self._agility, place, seconds=seconds)

    def takeoff(self, item: MissionItem, place: Place, state: AircraftState) -> Manoeuvre:
        """Straight up; the item's place is not looked at."""
        return Rise(self._agility, state, place.altitude_m)

    def land(self, start: Place, place: Place) -> Manoeuvre:
        """Over the place as high as it is, then down."""
        return self._descent(replace(place, altitude_m=start.altitude_m))

    def loiter(
        self, item: MissionItem, place: Place, state: AircraftState, onwards: Place | None
    ) -> Manoeuvre:
        """Stays at the item's place; turns are flown where the item asks for them."""
        agility = self._agility
        match item.command:
            case Command.NAV_LOITER_TURNS if abs(item.param3) >= 1.0:
                return Circle(agility, place, item.param3, item.param1)
            case Command.NAV_LOITER_TURNS:
                # Without a radius it turns on the spot, which takes no time worth telling.
                return Stay(agility, place, seconds=0.0)
            case Command.NAV_LOITER_TIME:
                return Stay(agility, place, seconds=max(item.param1, 0.0))
            case Command.NAV_DELAY:
                return Stay(agility, stopping_place(state, agility), seconds=max(item.param1, 0.0))
        return Stay(agility, place, until_altitude=item.command == Command.NAV_LOITER_TO_ALT)

    def wait(self, state: AircraftState, place: Place | None = None) -> Manoeuvre:
        """Brakes and stays."""
        return Stay(self._agility, place or stopping_place(state, self._agility))

    def go(self, state: AircraftState, place: Place) -> Manoeuvre:
        """There, and stays."""
        return Stay(self._agility, place)

    def come_home(self, state: AircraftState, home: Place) -> Manoeuvre:
        """Up to the return altitude, home, and down."""
        return Return(
            self._agility,
            state,
            home,
            altitude_m=home.altitude_m + self._settings.rtl_altitude_m,
            ground_m=self._settings.home.altitude_m,
            slow_below_m=self._slow_below_m,
            slow_m_s=self._slow_m_s,
        )

    def touch_down(self, state: AircraftState) -> Manoeuvre:
        """Land where it is."""
        return self._descent(stopping_place(state, self._agility))

    def _descent(self, place: Place) -> Manoeuvre:
        return Descent(
            self._agility,
            place,
            ground_m=self._settings.home.altitude_m,
            slow_below_m=self._slow_below_m,
            slow_m_s=self._slow_m_s,
        )
