"""Small plans made by hand, from exact straights and arcs."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from planner.angles import heading_from_angle
from planner.dubins.path import Path, Segment
from planner.frames import LocalFrame
from planner.plan import (
    AltitudeReference,
    Collect,
    Fence,
    Finish,
    FlownPath,
    Footprint,
    LonLat,
    Metrics,
    PathSegment,
    Phase,
    PhaseKind,
    Plan,
    PlanVehicle,
    PlanWind,
    ZonePolygon,
)
from planner.route import Pose

FRAME = LocalFrame(-117.75, 33.49)
STILL_AIR = PlanWind()
START = Pose(0.0, 0.0, 0.4)


@dataclass(frozen=True, slots=True)
class Leg:
    """A piece of a path: a straight of ``length_m``, or an arc of ``turn_deg`` to the left (> 0) or right.

    ``climb_m`` is climbed on the spot behind it, by what hovers.
    """

    length_m: float = 0.0
    turn_deg: float = 0.0
    radius_m: float = 100.0
    collect_m: tuple[float, float] | None = None
    climb_m: float = 0.0


LEGS = (
    Leg(length_m=1500.0, collect_m=(500.0, 1200.0)),
    Leg(turn_deg=180.0, radius_m=120.0),
    Leg(length_m=1500.0, collect_m=(200.0, 1300.0)),
    Leg(turn_deg=-250.0, radius_m=150.0),
    Leg(length_m=700.0),
)


def flown(legs: tuple[Leg, ...], start: Pose) -> Path:
    """The exact path of the legs, in local metres."""
    segments: list[Segment] = []
    pose = start
    for leg in legs:
        if leg.turn_deg:
            kind: Literal["left", "right"] = "left" if leg.turn_deg > 0 else "right"
            segment = Segment(kind, pose, math.radians(abs(leg.turn_deg)) * leg.radius_m, leg.radius_m)
        else:
            segment = Segment("straight", pose, leg.length_m)
        segments.append(segment)
        pose = segment.end
    return Path(tuple(segments))


def lonlat(point: tuple[float, float]) -> LonLat:
    """WGS 84 of local metres."""
    lon_deg, lat_deg = FRAME.to_wgs84(point)
    return float(lon_deg), float(lat_deg)


#: Of the flights' ends: height and length of the run, radius of turns, height and length of the approach.
RUN_M, RUN_HEIGHT_M = 350.0, 50.0
CIRCLE_M = 105.0
APPROACH_M, APPROACH_HEIGHT_M = 580.0, 40.0
TURNS = 3
#: Length over the ground for a metre of height, where no circles are flown for it.
RUN_A_METRE = 10.0
SPEED_M_S = 20.0


@dataclass(frozen=True, slots=True)
class Piece:
    """A segment of the flight, or None for a climb on the spot, with its phase, heights and collect."""

    phase: PhaseKind
    segment: Segment | None
    place: Pose
    from_m: float
    to_m: float
    collect_m: tuple[float, float] | None = None

    @property
    def length_m(self) -> float:
        """In three dimensions."""
        over_m = 0.0 if self.segment is None else self.segment.length_m
        return math.hypot(over_m, self.to_m - self.from_m)


def flight_of(
    legs: tuple[Leg, ...],
    start: Pose,
    vehicle_type: str,
    top_m: float,
    finish: Finish,
    ground_m: float,
    circles: bool = True,
) -> list[Piece]:
    """The whole flight: up before the legs, down behind them."""
    path = flown(legs, start)
    hovers = vehicle_type == "multirotor"
    lift_m = {"fixed_wing": 0.0, "vtol": min(RUN_HEIGHT_M, top_m), "multirotor": top_m}[vehicle_type]
    pieces: list[Piece] = []
    run = Segment("straight", start if hovers else _behind(start, RUN_M), RUN_M)
    low_m = ground_m + lift_m
    if lift_m:
        first_m = ground_m + min(10.0, lift_m) if hovers else low_m
        pieces.append(Piece("take_off", None, run.start, ground_m, first_m))
        if hovers:
            pieces.append(Piece("climb", None, run.start, first_m, ground_m + top_m))
    top_m += ground_m
    if not hovers:
        run_end_m = low_m if lift_m else min(low_m + RUN_HEIGHT_M, top_m)
        climb_m = 0.0 if circles else RUN_A_METRE * (top_m - run_end_m)
        run = replace(run, start=_behind(run.start, climb_m))
        pieces.append(Piece("take_off", run, run.start, low_m, run_end_m))
        if circles:
            pieces.append(Piece("climb", _turns("left", start), start, run_end_m, top_m))
        elif climb_m > 0.0:
            climb = Segment("straight", run.end, climb_m)
            pieces.append(Piece("mission", climb, climb.start, run_end_m, top_m))
    for leg, segment in zip(legs, path.segments, strict=True):
        pieces.append(Piece("mission", segment, segment.start, top_m, top_m, leg.collect_m))
        if leg.climb_m:
            pieces.append(Piece("mission", None, segment.end, top_m, top_m + leg.climb_m))
            top_m += leg.climb_m
    end = path.end
    if hovers:
        down_m = top_m if finish == "loiter" else ground_m
        return pieces if finish == "loiter" else [*pieces, Piece("landing", None, end, top_m, down_m)]
    bottom_m = {"land": ground_m + APPROACH_HEIGHT_M, "return": ground_m + 100.0, "loiter": top_m}[finish]
    bottom_m = min(bottom_m, top_m)
    if circles or finish != "land":
        pieces.append(Piece("return", _turns("right", end), end, top_m, bottom_m))
    elif top_m > bottom_m:
        descent = Segment("straight", end, RUN_A_METRE * (top_m - bottom_m))
        pieces.append(Piece("mission", descent, end, top_m, bottom_m))
        end = descent.end
    if finish == "land":
        approach = Segment("straight", end, APPROACH_M)
        touch_m = bottom_m if lift_m else ground_m
        pieces.append(Piece("landing", approach, end, bottom_m, touch_m))
        if lift_m:
            pieces.append(Piece("landing", None, approach.end, bottom_m, ground_m))
    return pieces


def _turns(kind: Literal["left", "right"], pose: Pose) -> Segment:
    return Segment(kind, pose, TURNS * math.tau * CIRCLE_M, CIRCLE_M)


def _behind(pose: Pose, distance_m: float) -> Pose:
    return Pose(
        pose.east_m - distance_m * math.cos(pose.angle_rad),
        pose.north_m - distance_m * math.sin(pose.angle_rad),
        pose.angle_rad,
    )


def _path_segment(piece: Piece, along_m: float) -> PathSegment:
    heights = (piece.from_m, piece.to_m)
    segment, place = piece.segment, lonlat(piece.place.position)
    if segment is None:
        return PathSegment("vertical", place, place, along_m, piece.length_m, None, None, None, *heights)
    straight = segment.kind == "straight"
    return PathSegment(
        segment.kind,
        place,
        lonlat(segment.end.position),
        along_m,
        piece.length_m,
        None if straight else segment.radius_m,
        None if segment.centre is None else lonlat(segment.centre),
        None if straight else abs(math.degrees(segment.turn_rad)),
        *heights,
    )


def _collect(piece: Piece, along_m: float, number: int) -> Collect:
    assert piece.segment is not None
    assert piece.collect_m is not None
    first_m, last_m = piece.collect_m
    ends = [lonlat(piece.segment.at(distance_m).position) for distance_m in piece.collect_m]
    return Collect(
        vehicle="uav-1",
        seq=number,
        roi=f"R{number + 1}",
        regions=(f"R{number + 1}",),
        sensor="sar",
        look="right",
        line=((*ends[0], piece.from_m), (*ends[1], piece.from_m)),
        heading_deg=heading_from_angle(piece.place.angle_rad),
        start_m=along_m + first_m,
        end_m=along_m + last_m,
        start_s=(along_m + first_m) / SPEED_M_S,
        end_s=(along_m + last_m) / SPEED_M_S,
    )


def _vertices(piece: Piece) -> list[tuple[float, float, float]]:
    if piece.segment is None:
        place = lonlat(piece.place.position)
        return [(*place, piece.from_m), (*place, piece.to_m)]
    rows = Path((piece.segment,)).sample(10.0)
    rise_m = piece.to_m - piece.from_m
    return [
        (*lonlat((east, north)), piece.from_m + rise_m * at_m / piece.segment.length_m)
        for east, north, _, at_m in rows
    ]


def _phases(pieces: list[Piece]) -> tuple[Phase, ...]:
    phases: list[Phase] = []
    along_m = 0.0
    for piece in pieces:
        end_m = along_m + piece.length_m
        if phases and phases[-1].kind == piece.phase:
            phases[-1] = replace(phases[-1], end_m=end_m, end_s=end_m / SPEED_M_S)
        else:
            phases.append(Phase(piece.phase, along_m, end_m, along_m / SPEED_M_S, end_m / SPEED_M_S))
        along_m = end_m
    return tuple(phases)


def make_plan(
    legs: tuple[Leg, ...] = LEGS,
    *,
    vehicle_type: Literal["fixed_wing", "multirotor", "vtol"] = "fixed_wing",
    autopilot: Literal["ardupilot", "px4"] = "ardupilot",
    start: Pose = START,
    altitude_m: float = 300.0,
    altitude_reference: AltitudeReference = "terrain",
    ground_m: float = 0.0,
    fence: Fence | None = None,
    finish: Finish = "land",
    min_turn_radius_m: float = 100.0,
    circles: bool = True,
    wind: PlanWind = STILL_AIR,
) -> Plan:
    """A plan of one vehicle whose mission is exactly the legs: the whole flight.

    ``altitude_m`` counts from the ground at home, which is at ``ground_m`` over the plan's datum. Without
    ``circles`` wings climb straight to the legs, and come straight down from them to a landing: both belong
    to the mission.
    """
    pieces = flight_of(legs, start, vehicle_type, altitude_m, finish, ground_m, circles)
    segments: list[PathSegment] = []
    collects: list[Collect] = []
    line: list[tuple[float, float, float]] = []
    along_m = 0.0
    for piece in pieces:
        segments.append(_path_segment(piece, along_m))
        if piece.collect_m is not None:
            collects.append(_collect(piece, along_m, len(collects)))
        line += _vertices(piece)[1 if line else 0 :]
        along_m += piece.length_m
    phases = _phases(pieces)
    mission = next(phase for phase in phases if phase.kind == "mission")
    mission_m = mission.end_m - mission.start_m
    home = line[0][:2]
    heading_deg = None if vehicle_type == "multirotor" else heading_from_angle(start.angle_rad)
    path = FlownPath(
        "uav-1", tuple(line), tuple(segments), along_m, along_m / SPEED_M_S, None, 100.0, phases, heading_deg
    )
    collected_m = sum(collect.end_m - collect.start_m for collect in collects)
    return Plan(
        name="by hand",
        vehicles=(PlanVehicle("uav-1", vehicle_type, autopilot, SPEED_M_S, min_turn_radius_m, 8.0, finish),),
        altitude_m=altitude_m + ground_m,
        altitude_reference=altitude_reference,
        home=home,
        end=home if finish == "return" else lonlat(_end_of(pieces).position),
        paths=(path,),
        collects=tuple(collects),
        transits=(),
        footprints=tuple(_footprint(collect) for collect in collects),
        uncovered=(),
        fence=square_fence(6000.0) if fence is None else fence,
        metrics=Metrics(
            length_m=mission_m,
            collection_length_m=collected_m,
            duty_cycle=collected_m / mission_m,
            path_length_ratio=None,
            risk_missile=0.0,
            risk_radar=0.0,
            turns=sum(1 for leg in legs if leg.turn_deg),
            duration_s=mission_m / SPEED_M_S,
            energy_wh=None,
            coverage={collect.roi: 1.0 for collect in collects},
            flight_length_m=along_m,
            flight_duration_s=along_m / SPEED_M_S,
        ),
        violations=(),
        methods={},
        scenario_hash="",
        planner_version="0",
        seed=0,
        wind=wind,
    )


def _end_of(pieces: list[Piece]) -> Pose:
    last = pieces[-1]
    return last.place if last.segment is None else last.segment.end


def _footprint(collect: Collect) -> Footprint:
    (lon0, lat0, _), (lon1, lat1, _) = collect.line
    ring = ((lon0, lat0), (lon1, lat1), (lon1, lat1 - 0.002), (lon0, lat0 - 0.002))
    return Footprint(collect.vehicle, collect.seq, collect.roi, collect.sensor, ring, 1.0)


def square_fence(half_m: float) -> Fence:
    """A square operating area round the frame's origin."""
    corners = ((-half_m, -half_m), (half_m, -half_m), (half_m, half_m), (-half_m, half_m))
    return Fence(inclusion=(ZonePolygon("area", tuple(lonlat(corner) for corner in corners)),))
