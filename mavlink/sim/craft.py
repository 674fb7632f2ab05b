"""What the kinds of aircraft make of the same order: to take off, fly a line, wait, land, return."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from mavlink.sim.dynamics import AircraftState, FlightCommand
from mavlink.sim.geodesy import Place
from mavlink.sim.manoeuvres import Manoeuvre
from mavlink.wire.items import Command, MissionItem

#: Navigation items of every kind of aircraft.
NAVIGATION = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TURNS,
        Command.NAV_LOITER_TIME,
        Command.NAV_RETURN_TO_LAUNCH,
        Command.NAV_LAND,
        Command.NAV_TAKEOFF,
        Command.NAV_LOITER_TO_ALT,
    }
)

#: Of a VTOL, to an aircraft that is none: plain ones.
PLAIN: dict[int, int] = {
    Command.NAV_VTOL_TAKEOFF: Command.NAV_TAKEOFF,
    Command.NAV_VTOL_LAND: Command.NAV_LAND,
}


@dataclass(frozen=True, slots=True)
class Vertex:
    """A waypoint of a path: its place, and the distance at which it counts as reached."""

    place: Place
    acceptance_m: float


class Path(Protocol):
    """Waypoints flown one after the other."""

    @property
    def cross_track_m(self) -> float:
        """Distance to the right of the leg being flown."""

    @property
    def finished(self) -> bool:
        """Whether the last vertex has been passed."""

    def passed(self, state: AircraftState, acceptance_m: float = 0.0) -> bool:
        """Whether the vertex being flown to is passed; steps on to the next leg if so."""

    def distance_to_target_m(self, state: AircraftState) -> float:
        """Straight distance to the vertex being flown to."""

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """What to do at this instant."""


class Craft(Protocol):
    """One kind of aircraft under one autopilot."""

    @property
    def navigation(self) -> frozenset[int]:
        """The commands it navigates by; all others are carried out between them."""

    @property
    def glides(self) -> bool:
        """Whether it flies straight on from the last waypoint to a landing place."""

    def flown_as(self, item: MissionItem) -> MissionItem:
        """The item it flies for one of a mission: those of other kinds of aircraft as its own."""

    def path(self, start: Place, vertices: Sequence[Vertex]) -> Path:
        """Straight lines through waypoints."""

    def acceptance_m(self, item: MissionItem) -> float:
        """How far before a waypoint it counts as reached."""

    def stop_s(self, item: MissionItem) -> float:
        """How long it stops at a waypoint; 0 where it passes."""

    def stop(self, place: Place, seconds: float) -> Manoeuvre:
        """Stay at a waypoint for a time."""

    def takeoff(self, item: MissionItem, place: Place, state: AircraftState) -> Manoeuvre:
        """Off the ground; ``place`` is the item's."""

    def land(self, start: Place, place: Place) -> Manoeuvre:
        """Down at a place, from where the last leg begins."""

    def loiter(
        self, item: MissionItem, place: Place, state: AircraftState, onwards: Place | None
    ) -> Manoeuvre:
        """An item that waits or circles; ``onwards`` is where the next one leads."""

    def wait(self, state: AircraftState, place: Place | None = None) -> Manoeuvre:
        """Wait in the air, here or at a place, until told otherwise."""

    def go(self, state: AircraftState, place: Place) -> Manoeuvre:
        """Go straight to a place and wait there."""

    def come_home(self, state: AircraftState, home: Place) -> Manoeuvre:
        """Break off and come back."""

    def touch_down(self, state: AircraftState) -> Manoeuvre:
        """Land as soon as may be."""
