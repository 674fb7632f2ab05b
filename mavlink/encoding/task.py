"""One vehicle's part of a plan, with the dialect and options it is encoded in."""

from __future__ import annotations

import math
from dataclasses import dataclass

from mavlink.dialects import Autopilot, Dialect, dialect_for
from mavlink.encoding.fence import Room, room_of
from mavlink.encoding.options import EncodeError, EncodeOptions
from mavlink.encoding.stops import MERGE_M, is_whole_turns
from mavlink.wire.geometry import LocalMap
from mavlink.wire.items import Frame
from planner.plan import Collect, FlownPath, PathSegment, PhaseKind, Plan, PlanVehicle

#: NPFG_SW_DST_MLT · NPFG_PERIOD · NPFG_DAMPING, as PX4 has them by default.
_PX4_TURNS_EARLY_S = 0.32 * 10.0 * 0.7
#: NAV_ACC_RAD of PX4's multirotors, by default, and a hundredth more: PX4 measures on a sphere.
_PX4_ACCEPTANCE_M = 1.01 * 2.0


@dataclass(frozen=True, slots=True)
class Task:
    """All that the parts of a mission are made from; ``local`` has its origin at home."""

    plan: Plan
    vehicle: PlanVehicle
    path: FlownPath
    collects: tuple[Collect, ...]
    dialect: Dialect
    options: EncodeOptions
    local: LocalMap
    room: Room

    @property
    def is_px4(self) -> bool:
        """Whether the autopilot is PX4."""
        return self.dialect.autopilot == "px4"

    @property
    def is_plane(self) -> bool:
        """Whether it is ArduPlane."""
        return not self.is_px4 and not self.hovers

    @property
    def hovers(self) -> bool:
        """Whether the vehicle is a multirotor."""
        return self.vehicle.type == "multirotor"

    @property
    def turns_early_m(self) -> float:
        """How far before a waypoint the vehicle turns to the next one, whatever the item says."""
        if self.is_px4 and self.hovers:
            return _PX4_ACCEPTANCE_M
        return _PX4_TURNS_EARLY_S * self.vehicle.airspeed_m_s if self.is_px4 else 0.0

    @property
    def near_m(self) -> float:
        """Places nearer to others than this are better not named: PX4's multirotors stop before such ones."""
        return self.turns_early_m + MERGE_M if self.is_px4 and self.hovers else 0.0

    @property
    def off_delay_m(self) -> float:
        """How far past a collect's end its waypoint lies."""
        delay_m = self.options.off_delay_m
        return self.turns_early_m if delay_m is None else delay_m

    @property
    def frame(self) -> int:
        """Frame of the plan's altitude."""
        # Without a raster the ground is flat at the height of home, so heights over it count from home.
        return Frame.GLOBAL if self.plan.altitude_reference == "amsl" else Frame.GLOBAL_RELATIVE_ALT

    @property
    def altitude_over_home_m(self) -> float:
        """The plan's altitude over home."""
        return self.over_home_m(self.plan.altitude_m)

    @property
    def any_yaw(self) -> float:
        """Param 4 that leaves the heading to the autopilot."""
        return math.nan if self.is_px4 else 0.0

    def over_home_m(self, altitude_m: float) -> float:
        """An altitude of the plan over home, where its path begins."""
        return altitude_m - self.home_altitude_m

    @property
    def home_altitude_m(self) -> float:
        """Of home over the plan's datum: where the path begins, unless that is in the air."""
        aloft_m = self.vehicle.home_altitude_m
        return self.path.line[0][2] if aloft_m is None else aloft_m

    def phase_end_m(self, kind: PhaseKind) -> float:
        """Where a phase ends along the path; its beginning where there is no such phase."""
        phase = self.path.phase(kind)
        return 0.0 if phase is None else phase.end_m

    @property
    def taken_off_m(self) -> float:
        """Where the take-off item ends: with the phase, or as high as the path climbs on the spot."""
        end_m = self.phase_end_m("take_off")
        for segment in self.path.segments:
            if segment.kind != "vertical" or segment.start_m > end_m + MERGE_M:
                break
            end_m = max(end_m, segment.start_m + segment.length_m)
        return end_m

    @property
    def mission_end_m(self) -> float:
        """Where the mission phase ends along the path."""
        phase = self.path.phase("mission")
        return self.path.length_m if phase is None else phase.end_m

    @property
    def landing_m(self) -> float:
        """Where the landing begins along the path; its end where the flight does not land."""
        phase = self.path.phase("landing")
        return self.path.length_m if phase is None else phase.start_m

    @property
    def last_turns(self) -> PathSegment | None:
        """The whole turns that the path ends in; None where it ends otherwise."""
        last = self.path.segments[-1]
        return last if is_whole_turns(last) else None


def task_of(plan: Plan, name: str | None, autopilot: Autopilot | None, options: EncodeOptions) -> Task:
    """The task of one vehicle; EncodeError where there is nothing to encode."""
    vehicle = _vehicle(plan, name)
    sorties = plan.sorties_of(vehicle.name)
    if not sorties:
        raise EncodeError(f"the plan has no path for {vehicle.name!r}")
    if options.sortie not in sorties:
        numbers = ", ".join(map(str, sorties))
        raise EncodeError(f"{vehicle.name!r} has no sortie {options.sortie}, only {numbers}")
    plan = plan.of(vehicle.name, options.sortie)
    path = plan.path_of(vehicle.name, options.sortie)
    if not path.segments or path.length_m <= 0.0:
        raise EncodeError(f"the plan has no path for {vehicle.name!r}")
    collects = plan.collects_of(vehicle.name)
    for collect in collects:
        if not collect.start_m < collect.end_m:
            raise EncodeError(f"collect {collect.seq} of {vehicle.name!r} ends where it starts")
    local = LocalMap(plan.home)
    task = Task(
        plan,
        vehicle,
        path,
        collects,
        dialect_for(autopilot or vehicle.autopilot, vehicle.type),
        options,
        local,
        room_of(plan.fence, local),
    )
    if path.phase("take_off") is None and vehicle.home_altitude_m is None:
        raise EncodeError("the plan's path has no take-off: plan again")
    if not task.altitude_over_home_m > 0.0:
        raise EncodeError(f"the plan's altitude is {task.altitude_over_home_m:g} m over home")
    return task


def _vehicle(plan: Plan, name: str | None) -> PlanVehicle:
    names = ", ".join(vehicle.name for vehicle in plan.vehicles)
    if name is None:
        if len(plan.vehicles) != 1:
            raise EncodeError(f"the plan has several vehicles, one must be named: {names}")
        return plan.vehicles[0]
    for vehicle in plan.vehicles:
        if vehicle.name == name:
            return vehicle
    raise EncodeError(f"the plan has no vehicle {name!r}, only {names}")
