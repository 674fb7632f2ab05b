"""Small plans made by hand, from exact straights and arcs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from planner.angles import heading_from_angle
from planner.dubins.path import Path, Segment
from planner.frames import LocalFrame
from planner.plan import (
    AltitudeReference,
    Collect,
    Fence,
    FlownPath,
    Footprint,
    LonLat,
    Metrics,
    PathSegment,
    Plan,
    PlanVehicle,
    ZonePolygon,
)
from planner.route import Pose

FRAME = LocalFrame(-117.75, 33.49)
START = Pose(0.0, 0.0, 0.4)


@dataclass(frozen=True, slots=True)
class Leg:
    """A piece of a path: a straight of ``length_m``, or an arc of ``turn_deg`` to the left (> 0) or right."""

    length_m: float = 0.0
    turn_deg: float = 0.0
    radius_m: float = 100.0
    collect_m: tuple[float, float] | None = None


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


def make_plan(
    legs: tuple[Leg, ...] = LEGS,
    *,
    vehicle_type: Literal["fixed_wing", "multirotor", "vtol"] = "fixed_wing",
    autopilot: Literal["ardupilot", "px4"] = "ardupilot",
    start: Pose = START,
    altitude_m: float = 300.0,
    altitude_reference: AltitudeReference = "terrain",
    fence: Fence | None = None,
    ends_at_home: bool = False,
    min_turn_radius_m: float = 100.0,
) -> Plan:
    """A plan of one vehicle whose path is exactly the legs."""
    path = flown(legs, start)
    segments: list[PathSegment] = []
    collects: list[Collect] = []
    along_m = 0.0
    speed_m_s = 20.0
    for leg, segment in zip(legs, path.segments, strict=True):
        straight = segment.kind == "straight"
        segments.append(
            PathSegment(
                segment.kind,
                lonlat(segment.start.position),
                lonlat(segment.end.position),
                along_m,
                segment.length_m,
                None if straight else segment.radius_m,
                None if segment.centre is None else lonlat(segment.centre),
                None if straight else abs(leg.turn_deg),
            )
        )
        if leg.collect_m is not None:
            first_m, last_m = leg.collect_m
            collects.append(
                Collect(
                    vehicle="uav-1",
                    seq=len(collects),
                    roi=f"R{len(collects) + 1}",
                    regions=(f"R{len(collects) + 1}",),
                    sensor="sar",
                    look="right",
                    line=(
                        (*lonlat(segment.at(first_m).position), altitude_m),
                        (*lonlat(segment.at(last_m).position), altitude_m),
                    ),
                    heading_deg=heading_from_angle(segment.start.angle_rad),
                    start_m=along_m + first_m,
                    end_m=along_m + last_m,
                    start_s=(along_m + first_m) / speed_m_s,
                    end_s=(along_m + last_m) / speed_m_s,
                )
            )
        along_m += segment.length_m
    home = lonlat(path.start.position)
    line = tuple((*lonlat((east, north)), altitude_m) for east, north, _, _ in path.sample(10.0))
    collected_m = sum(collect.end_m - collect.start_m for collect in collects)
    return Plan(
        name="by hand",
        vehicles=(PlanVehicle("uav-1", vehicle_type, autopilot, speed_m_s, min_turn_radius_m),),
        altitude_m=altitude_m,
        altitude_reference=altitude_reference,
        home=home,
        end=home if ends_at_home else lonlat(path.end.position),
        paths=(
            FlownPath("uav-1", line, tuple(segments), path.length_m, path.length_m / speed_m_s, None, 100.0),
        ),
        collects=tuple(collects),
        transits=(),
        footprints=tuple(_footprint(collect) for collect in collects),
        uncovered=(),
        fence=square_fence(6000.0) if fence is None else fence,
        metrics=Metrics(
            length_m=path.length_m,
            collection_length_m=collected_m,
            duty_cycle=collected_m / path.length_m,
            path_length_ratio=None,
            risk_missile=0.0,
            risk_radar=0.0,
            turns=sum(1 for segment in segments if segment.kind != "straight"),
            duration_s=path.length_m / speed_m_s,
            energy_wh=None,
            coverage={collect.roi: 1.0 for collect in collects},
        ),
        violations=(),
        methods={},
        scenario_hash="",
        planner_version="0",
        seed=0,
    )


def _footprint(collect: Collect) -> Footprint:
    (lon0, lat0, _), (lon1, lat1, _) = collect.line
    ring = ((lon0, lat0), (lon1, lat1), (lon1, lat1 - 0.002), (lon0, lat0 - 0.002))
    return Footprint(collect.vehicle, collect.seq, collect.roi, collect.sensor, ring, 1.0)


def square_fence(half_m: float) -> Fence:
    """A square operating area round the frame's origin."""
    corners = ((-half_m, -half_m), (half_m, -half_m), (half_m, half_m), (-half_m, half_m))
    return Fence(inclusion=(ZonePolygon("area", tuple(lonlat(corner) for corner in corners)),))
