"""The plan: what comes out, in WGS 84 degrees and SI units, ready for GeoJSON and for MAVLink.

This is the one module of the planner that ``mavlink`` may import, so it imports nothing heavy and its
values are plain numbers and tuples. Distances along a path (``start_m`` …) count from the path's start.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

LonLat = tuple[float, float]
LonLatAlt = tuple[float, float, float]
Ring = tuple[LonLat, ...]

AltitudeReference = Literal["amsl", "home", "terrain"]
SegmentKind = Literal["straight", "left", "right", "vertical"]
PhaseKind = Literal["take_off", "climb", "mission", "return", "landing"]
#: How a flight ends: on the ground, circling over home until a pilot lands it, circling over its end.
Finish = Literal["land", "return", "loiter"]
#: What releases a camera.
Trigger = Literal["distance", "time", "video"]


@dataclass(frozen=True, slots=True)
class PlanVehicle:
    """What the mission needs to know of the aircraft."""

    name: str
    type: Literal["fixed_wing", "multirotor", "vtol"]
    autopilot: Literal["ardupilot", "px4"]
    airspeed_m_s: float
    min_turn_radius_m: float
    max_climb_deg: float = 8.0
    finish: Finish = "land"


@dataclass(frozen=True, slots=True)
class PlanWind:
    """The steady wind that the plan is made for: its speed, and where it comes from, from true north."""

    speed_m_s: float = 0.0
    from_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class PathSegment:
    """A straight, a circular arc or a climb on the spot: a piece of a path whose slope is even.

    Parameters
    ----------
    kind
        ``left`` and ``right`` are arcs; ``vertical`` is flown by what hovers.
    start, end
        Longitude, latitude in degrees.
    start_m, length_m
        Along the path, in three dimensions.
    radius_m, centre, turn_deg
        Of an arc: radius, centre, and degrees turned (> 0; more than 360 where it climbs or descends in
        circles); None for a straight.
    start_altitude_m, end_altitude_m
        Over the plan's ``altitude_reference``.
    """

    kind: SegmentKind
    start: LonLat
    end: LonLat
    start_m: float
    length_m: float
    radius_m: float | None = None
    centre: LonLat | None = None
    turn_deg: float | None = None
    start_altitude_m: float = 0.0
    end_altitude_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Phase:
    """A part of a flight: where and when it begins and ends, counted along the path from lift-off."""

    kind: PhaseKind
    start_m: float
    end_m: float
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class FlownPath:
    """The whole line one vehicle flies, from lift-off to landing or to the circle that its return ends in.

    ``line`` has vertices at most 10 m apart on arcs; straights need only their ends. Altitudes are over the
    plan's ``altitude_reference``; distances along it are in three dimensions. ``phases`` follow each other
    without gaps; ``take_off_heading_deg`` is where the aircraft must point at lift-off, None for what hovers.
    """

    vehicle: str
    line: tuple[LonLatAlt, ...]
    segments: tuple[PathSegment, ...]
    length_m: float
    duration_s: float
    energy_wh: float | None
    min_turn_radius_m: float | None
    phases: tuple[Phase, ...] = ()
    take_off_heading_deg: float | None = None
    sortie: int = 1

    def phase(self, kind: PhaseKind) -> Phase | None:
        """The phase of a kind; None where the flight has none."""
        return next((phase for phase in self.phases if phase.kind == kind), None)


@dataclass(frozen=True, slots=True)
class Collect:
    """Sensor on from the first to the last point of a straight line, in flight direction."""

    vehicle: str
    seq: int
    roi: str
    regions: tuple[str, ...]
    sensor: str
    look: Literal["left", "right", "down"]
    line: tuple[LonLatAlt, LonLatAlt]
    heading_deg: float
    start_m: float
    end_m: float
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class Transit:
    """The line between two collects, or from the start, or to the end.

    ``clearance_m`` is proven: the line comes no nearer to anything hard at its level; None where there is
    none.
    """

    vehicle: str
    seq: int
    from_name: str
    to_name: str
    line: tuple[LonLatAlt, ...]
    length_m: float
    risk_missile: float
    risk_radar: float
    method: str
    clearance_m: float | None = None


@dataclass(frozen=True, slots=True)
class PlanCamera:
    """What a mission and the judge of its flight need to know of a camera.

    Parameters
    ----------
    focal_length_m, pixel_pitch_m
        Of the lens itself, and between pixels.
    columns, rows
        Pixels across and along the flight direction, as it is mounted.
    forward_overlap, side_overlap
        Parts of a photo that the next, and that of the next lane, see again.
    tilt_deg
        Of its axis, from straight down forwards.
    min_interval_s
        Shortest time between two photos; 0 where unknown.
    trigger
        Photos by distance flown, by time, or one video for each collect.
    model
        Its name in the camera database; None for one given by its figures.
    """

    name: str
    focal_length_m: float
    pixel_pitch_m: float
    columns: int
    rows: int
    forward_overlap: float
    side_overlap: float
    tilt_deg: float = 0.0
    min_interval_s: float = 0.0
    trigger: Trigger = "distance"
    model: str | None = None
    spectrum: Literal["visible", "infrared"] = "visible"


@dataclass(frozen=True, slots=True)
class Photos:
    """Where the photos of one collect are taken, in order: the first at its start, the last at its end.

    Parameters
    ----------
    seq
        That of the collect.
    interval_m, interval_s
        Between two of them, over the ground and as flown; ``interval_s`` None where not timed.
    """

    vehicle: str
    seq: int
    sensor: str
    places: tuple[LonLatAlt, ...]
    interval_m: float
    interval_s: float | None = None


@dataclass(frozen=True, slots=True)
class Footprint:
    """Ground seen at full quality during one collect; on terrain a collect may have several.

    ``shadow_m2`` and ``layover_m2`` are the ground in the beam that terrain hides, of the whole collect.
    ``gsd_m`` and ``niirs`` are the worst inside it, ``gsd_mean_m`` and ``niirs_mean`` the means.
    """

    vehicle: str
    seq: int
    roi: str
    sensor: str
    ring: Ring
    resolution_m: float | None = None
    niirs: float | None = None
    holes: tuple[Ring, ...] = ()
    shadow_m2: float | None = None
    layover_m2: float | None = None
    gsd_m: float | None = None
    gsd_mean_m: float | None = None
    niirs_mean: float | None = None


@dataclass(frozen=True, slots=True)
class Uncovered:
    """What of a region no footprint sees: polygons as (outer ring, holes …)."""

    roi: str
    polygons: tuple[tuple[Ring, ...], ...]
    area_m2: float
    reason: str


@dataclass(frozen=True, slots=True)
class Violation:
    """A constraint that the plan does not keep.

    Parameters
    ----------
    constraint
        ``turn-radius``, ``area``, ``hard-zone``, ``coverage``, ``collect-straight``, ``settling``,
        ``continuity``, ``range``, ``flight-time``, ``energy``, ``soft-threat``.
    feature
        The region, zone or vehicle concerned.
    where
        The worst place; None where there is none.
    amount, unit
        By how much.
    hard
        Whether a plan with it may be uploaded only with an explicit override.
    """

    constraint: str
    feature: str
    message: str
    amount: float
    unit: str
    where: LonLat | None = None
    hard: bool = True


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A region that need not be seen and is not.

    Parameters
    ----------
    reason
        ``range``, ``flight-time``, ``energy``, or what keeps every pass from seeing it: ``swath``, ``area`` …
    margin
        By how much a flight with it is over that limit, in m, s or Wh; None for other reasons.
    """

    roi: str
    reason: str
    margin: float | None = None


@dataclass(frozen=True, slots=True)
class Surveyed:
    """What photos give of one region, as the judge measures it photo by photo.

    Parameters
    ----------
    forward_overlap, side_overlap
        Parts of a photo that the next one, and that of the next lane, see again: the least of any place.
    photos_least, photos_mean
        How many photos see a place.
    gsd_m, niirs
        The worst of any photo of a place of it; the means are those of the photos nearest to each place.
    """

    forward_overlap: float
    side_overlap: float
    photos_least: int
    photos_mean: float
    gsd_m: float | None = None
    gsd_mean_m: float | None = None
    niirs: float | None = None
    niirs_mean: float | None = None


@dataclass(frozen=True, slots=True)
class Metrics:
    """What the plan costs and gives.

    ``length_m`` and ``duration_s`` are those of the mission phase, from where take-off and climbing turns end
    to where descending turns or the landing begin; ``flight_length_m``, ``flight_duration_s`` and
    ``energy_wh`` of all phases. ``route_length_m`` is the line over the ground from start to end, without
    turns flown for height; ``lower_bound_m`` what no mission phase over these regions is shorter than,
    threats left out, and ``gap`` by what part of its length this one is longer; None without a bound.
    ``photos`` counts those of all cameras, ``photos_mb`` is about what they take to be stored; None where
    there are none on board. ``surveys`` tells by region what they give.
    """

    length_m: float
    collection_length_m: float
    duty_cycle: float
    path_length_ratio: float | None
    risk_missile: float
    risk_radar: float
    turns: int
    duration_s: float
    energy_wh: float | None
    coverage: dict[str, float]
    importance_collected: float | None = None
    planning_time_s: dict[str, float] = field(default_factory=dict)
    lower_bound_m: float | None = None
    gap: float | None = None
    flight_length_m: float | None = None
    flight_duration_s: float | None = None
    route_length_m: float | None = None
    left_out: tuple[LeftOut, ...] = ()
    photos: int | None = None
    photos_mb: float | None = None
    surveys: dict[str, Surveyed] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class ZonePolygon:
    """A horizontal polygon of the fence: the outer ring, without its closing point, and an altitude band."""

    name: str
    ring: Ring
    floor_m: float | None = None
    ceiling_m: float | None = None


@dataclass(frozen=True, slots=True)
class ZoneCircle:
    """A disc of the fence."""

    name: str
    centre: LonLat
    radius_m: float
    floor_m: float | None = None
    ceiling_m: float | None = None


@dataclass(frozen=True, slots=True)
class Fence:
    """Where the vehicles may and may not fly."""

    inclusion: tuple[ZonePolygon, ...] = ()
    exclusion: tuple[ZonePolygon, ...] = ()
    exclusion_circles: tuple[ZoneCircle, ...] = ()


@dataclass(frozen=True, slots=True)
class Plan:
    """Checked and measured; see contract role by role.

    ``home`` is where the vehicles take off (the scenario's start), ``end`` where they finish; both on the
    ground.
    """

    name: str
    vehicles: tuple[PlanVehicle, ...]
    altitude_m: float
    altitude_reference: AltitudeReference
    home: LonLat
    end: LonLat
    paths: tuple[FlownPath, ...]
    collects: tuple[Collect, ...]
    transits: tuple[Transit, ...]
    footprints: tuple[Footprint, ...]
    uncovered: tuple[Uncovered, ...]
    fence: Fence
    metrics: Metrics
    violations: tuple[Violation, ...]
    methods: dict[str, str]
    scenario_hash: str
    planner_version: str
    seed: int
    warnings: tuple[str, ...] = ()
    photos: tuple[Photos, ...] = ()
    cameras: tuple[PlanCamera, ...] = ()
    wind: PlanWind = PlanWind()

    def path_of(self, vehicle: str) -> FlownPath:
        """The path of one vehicle."""
        return next(path for path in self.paths if path.vehicle == vehicle)

    def collects_of(self, vehicle: str) -> tuple[Collect, ...]:
        """The collects of one vehicle in flight order."""
        return tuple(sorted((c for c in self.collects if c.vehicle == vehicle), key=lambda c: c.seq))

    def photos_of(self, vehicle: str) -> tuple[Photos, ...]:
        """The photos of one vehicle, those of each collect together, in flight order."""
        return tuple(sorted((p for p in self.photos if p.vehicle == vehicle), key=lambda p: p.seq))

    def camera(self, sensor: str) -> PlanCamera | None:
        """The camera of a name; None where that sensor is none."""
        return next((camera for camera in self.cameras if camera.name == sensor), None)

    @property
    def hard_violations(self) -> tuple[Violation, ...]:
        """Violations that forbid an upload without an explicit override."""
        return tuple(violation for violation in self.violations if violation.hard)
