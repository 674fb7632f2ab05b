"""The network of a scenario and its plan."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.lines import judge_lines, roomy
from planner.errors import Finding
from planner.plan import Collect, Plan
from planner.progress import Stop, never, raise_if
from planner.route import CollectPass, Pose
from planner.routing.joint.chain import estimates, from_start, to_end
from planner.scenario import Scenario
from planner.sensors.worth import Worth, worth_of
from planner.tasks.fleet.crews import Crew, crews_of
from planner.tasks.fleet.jobs import along_rad
from planner.tasks.network.candidates import HIDDEN_PART, View, part_of
from planner.tasks.network.segments import Line, Looked, Network, RecognitionSegment, angle_of

Floats = NDArray[np.float64]

#: How finely segments are told: headings so far apart, this many stand-offs. The first whose number is not
#: over ``MOST_SEGMENTS`` by far is taken.
FINENESS = ((45.0, 3), (90.0, 3), (90.0, 1))
MOST_SEGMENTS = 6_000
#: Segments of one sensor at one heading and stand-off: two sides.
SIDES = 2


@dataclass(frozen=True, slots=True, eq=False)
class _Flown:
    """A chosen segment, between what was flown before and after it by one aircraft."""

    collects: tuple[Collect, ...]
    crew: Crew
    lines: tuple[Line, ...]
    before: Pose | None
    after: Pose | None

    @property
    def name(self) -> str:
        """What the plan names as seen."""
        return self.collects[0].roi

    @property
    def regions(self) -> tuple[str, ...]:
        """What it sees."""
        return self.collects[0].regions


def network_of(scenario: Scenario, plan: Plan, only: Sequence[str] = (), stop: Stop = never) -> Network:
    """The segments round the targets of a plan: those it takes, those it could take, and those ruled out.

    Parameters
    ----------
    only
        Names of the targets to tell of; none for all.

    Raises
    ------
    CancelledError
        When ``stop`` says so.
    """
    crews, _ = crews_of(scenario)
    kinds: dict[tuple[object, ...], list[Crew]] = {}
    for crew in crews:
        kinds.setdefault(crew.kind, []).append(crew)
    regions = [each for each in scenario.regions if not only or each.name in only]
    flown = [each for each in _flown(scenario, plan, crews) if not only or set(each.regions) & set(only)]
    step_deg, stand_offs = _fineness(len(regions), list(kinds.values()))
    etas = np.linspace(0.0, 1.0, stand_offs) if stand_offs > 1 else np.array([0.5])
    segments = [_chosen(scenario, plan, each) for each in flown]
    looked: list[Looked] = []
    for region in regions:
        chosen = [each for each in flown if each.regions == (region.name,)]
        turns = np.arange(0.0, 360.0, step_deg)
        angles_rad = along_rad(region) + np.radians(turns)
        if region.approach_rad is not None:
            angles_rad = np.concatenate([np.array(region.approach_rad), angles_rad])
        asked = scenario.sensor_for(region).name
        for alike in kinds.values():
            for sensor in alike[0].setting.suite.sensors:
                raise_if(stop)
                view = View.of(tuple(alike), region, sensor.name)
                refused = view.refusal()
                names = tuple(crew.aircraft.name for crew in alike)
                looked.append(Looked(region.name, sensor.name, names, sensor.name == asked, refused))
                if refused is None:
                    segments += _round(view, angles_rad, etas, sensor.name == asked, asked, chosen, stop)
    return Network(tuple(segments), tuple(looked), math.radians(step_deg), stand_offs)


def _fineness(regions: int, kinds: Sequence[Sequence[Crew]]) -> tuple[float, int]:
    sensors = sum(len(alike[0].setting.suite.sensors) for alike in kinds)
    for step_deg, stand_offs in FINENESS:
        if regions * sensors * (360.0 / step_deg) * stand_offs * SIDES <= MOST_SEGMENTS:
            return step_deg, stand_offs
    return FINENESS[-1]


def _flown(scenario: Scenario, plan: Plan, crews: Sequence[Crew]) -> list[_Flown]:
    """The segments that a plan takes, flight by flight."""
    by_name = {crew.aircraft.name: crew for crew in crews}
    found: list[_Flown] = []
    flight = groupby(plan.collects, key=lambda each: (each.vehicle, each.sortie))
    for (vehicle, _), flights in flight:
        crew = by_name[vehicle]
        runs = [tuple(run) for _, run in groupby(flights, key=lambda each: (each.roi, each.sensor))]
        lines = [tuple(_line(scenario, collect) for collect in run) for run in runs]
        settle_m = crew.setting.model.settle_m
        for k, run in enumerate(runs):
            before = _egress(lines[k - 1]) if k > 0 else None
            after = _ingress(lines[k + 1], settle_m) if k + 1 < len(runs) else None
            found.append(_Flown(run, crew, lines[k], before, after))
    return found


def _line(scenario: Scenario, collect: Collect) -> Line:
    (east0, north0), (east1, north1) = scenario.frame.to_local([place[:2] for place in collect.line]).tolist()
    return (east0, north0), (east1, north1)


def _ingress(lines: Sequence[Line], settle_m: float) -> Pose:
    (east_m, north_m), _ = lines[0]
    angle_rad = angle_of(lines[0])
    return Pose(east_m - settle_m * math.cos(angle_rad), north_m - settle_m * math.sin(angle_rad), angle_rad)


def _egress(lines: Sequence[Line]) -> Pose:
    return Pose(*lines[-1][1], angle_of(lines[-1]))


def _chosen(scenario: Scenario, plan: Plan, flown: _Flown) -> RecognitionSegment:
    first, crew = flown.collects[0], flown.crew
    regions = [region for region in scenario.regions if region.name in flown.regions]
    region = replace(regions[0], area=_ground([each.area for each in regions]))
    view = View.of((crew,), region, first.sensor)
    numbers = {each.seq for each in flown.collects}
    prints = [p for p in plan.footprints if p.vehicle == first.vehicle and p.seq in numbers]
    local = [
        Polygon(
            scenario.frame.to_local(np.asarray(p.ring)),
            [scenario.frame.to_local(np.asarray(h)) for h in p.holes],
        )
        for p in prints
    ]
    niirs = [p.niirs for p in prints if p.niirs is not None]
    gsd_m = [p.gsd_m for p in prints if p.gsd_m is not None]
    worth = Worth(gsd_m=max(gsd_m, default=None), niirs=min(niirs, default=None))
    segment = _measured(view, flown.lines, first.look, part_of(local, region.area), worth)
    return replace(
        segment,
        target=flown.name,
        altitude_m=first.line[0][2],
        state="chosen",
        sortie=first.sortie if plan.is_fleet else None,
    )


def _ground(areas: Sequence[BaseGeometry]) -> Polygon | MultiPolygon:
    whole = shapely.union_all(areas)
    return whole if isinstance(whole, Polygon) else MultiPolygon(shapely.get_parts(whole).tolist())


def _measured(
    view: View, lines: tuple[Line, ...], look: str, seen: float, worth: Worth
) -> RecognitionSegment:
    middle = view.region.area.centroid
    ingress, egress = _ingress(lines, view.around.settle_m), _egress(lines)
    missile, radar = view.risks(lines)
    poses = np.array([[each.east_m, each.north_m, each.angle_rad] for each in (ingress, egress)])
    return RecognitionSegment(
        target=view.region.name,
        sensor=view.sensor.name,
        look=look,  # type: ignore[arg-type]
        lines=lines,
        altitude_m=view.level.altitude_m,
        ingress=ingress,
        egress=egress,
        vehicles=tuple(crew.aircraft.name for crew in view.crews),
        stand_off_m=min(float(LineString(line).distance(middle)) for line in lines),
        length_m=math.fsum(math.dist(*line) for line in lines),
        seen=seen,
        worth=worth,
        resolution_m=view.sensor.resolution_m,
        risk_missile=missile,
        risk_radar=radar,
        turns=bool(roomy(poses, view.around).all()),
        state="open",
    )


def _round(
    view: View,
    angles_rad: Floats,
    etas: Floats,
    as_asked: bool,
    asked: str,
    chosen: Sequence[_Flown],
    stop: Stop,
) -> Iterable[RecognitionSegment]:
    """The segments of one sensor round a target."""
    worth = worth_of(view.sensor, view.height_m, 0.0, 0.0)
    for area, passes in view.candidates(angles_rad, etas, stop):
        lines: tuple[Line, ...] = tuple((each.start, each.end) for each in passes)
        segment = _measured(view, lines, passes[0].look, view.seen_part(passes, area), worth)
        against = [*([] if as_asked else [_not_asked(view, asked)]), *_against(view, segment, passes)]
        inner_m = _inner_m(view, lines)
        vehicles, limits = _reached(view, segment, inner_m)
        if not vehicles:
            against += limits
        if against:
            yield replace(segment, state="ruled_out", ruled_out=tuple(against))
            continue
        longer_m = None
        own = next((each for each in chosen if each.collects[0].vehicle in vehicles), None)
        if own is not None:
            there_m = _through_m(view, own, segment.ingress, segment.egress, inner_m)
            as_flown_m = _through_m(
                view,
                own,
                _ingress(own.lines, view.around.settle_m),
                _egress(own.lines),
                _inner_m(view, own.lines),
            )
            longer_m = there_m - as_flown_m
        yield replace(
            segment,
            vehicles=vehicles,
            longer_m=longer_m if longer_m is not None and math.isfinite(longer_m) else None,
        )


def _not_asked(view: View, asked: str) -> Finding:
    message = f"{view.region.name} asks for sensor {asked}"
    return Finding(view.region.name, "sensor", message, f"Give it sensor {view.sensor.name}.")


def _against(view: View, segment: RecognitionSegment, passes: Sequence[CollectPass]) -> Iterable[Finding]:
    name = view.region.name
    if not all(view.allowed(each.angle_rad) for each in passes):
        yield Finding(
            name, "approach", "is not flown in a heading that approach_deg allows", "Allow it there."
        )
    yield from view.in_the_way(segment.lines)
    if segment.seen is not None and segment.seen < 1.0 - HIDDEN_PART:
        hidden = 1.0 - segment.seen
        message = f"does not see {hidden:.1%} of {name}: terrain or the beam's edge is in the way"
        yield Finding(
            name, "line-of-sight", message, "Another side or height, or two segments, see all of it."
        )


def _inner_m(view: View, lines: Sequence[Line]) -> float:
    """From ingress to egress: passes, and turns between them, wind and threats priced."""
    around = view.around
    free = view.free
    _, costs_m = judge_lines(np.array(lines)[:, None], free)
    between = 0.0
    for one, other in pairwise(lines):
        leave, arrive = _egress([one]), _ingress([other], around.settle_m)
        between += float(estimates(_rows(leave), _rows(arrive), around, around.discs)[0, 0])
    return float(costs_m.sum()) + between


def _rows(pose: Pose) -> Floats:
    return np.array([[pose.east_m, pose.north_m, pose.angle_rad]])


def _through_m(view: View, flown: _Flown, ingress: Pose, egress: Pose, inner_m: float) -> float:
    """From what was flown before to what is flown after, by way of a segment."""
    around, (start, end) = view.around, flown.crew.ends
    if flown.before is None:
        out_m = float(from_start(start, around, _rows(ingress), around.discs)[0])
    else:
        out_m = float(estimates(_rows(flown.before), _rows(ingress), around, around.discs)[0, 0])
    if flown.after is None:
        home_m = float(to_end(end, around, _rows(egress), around.discs)[0])
    else:
        home_m = float(estimates(_rows(egress), _rows(flown.after), around, around.discs)[0, 0])
    return out_m + inner_m + home_m


def _reached(
    view: View, segment: RecognitionSegment, inner_m: float
) -> tuple[tuple[str, ...], list[Finding]]:
    """Who can fly it and be home again within limits and its window; why the others cannot."""
    found: list[str] = []
    why: list[Finding] = []
    for crew in view.crews:
        finding = _too_far(view, crew, segment, inner_m)
        if finding is None:
            found.append(crew.aircraft.name)
        else:
            why.append(finding)
    return tuple(found), why


def _too_far(view: View, crew: Crew, segment: RecognitionSegment, inner_m: float) -> Finding | None:
    around, (start, end) = view.around, crew.ends
    model, name = crew.setting.model, crew.aircraft.name
    out_m = float(from_start(start, around, _rows(segment.ingress), around.discs)[0])
    home_m = float(to_end(end, around, _rows(segment.egress), around.discs)[0])
    whole_m = out_m + inner_m + home_m
    if not math.isfinite(whole_m):
        return Finding(name, "reach", f"{name} finds no way there and home", "See what is in the way.")
    seconds = whole_m / model.airspeed_m_s + crew.besides_s
    aircraft = model.aircraft
    limits = [
        ("flight-time", seconds, aircraft.max_flight_time_s, "s"),
        ("range", seconds * model.airspeed_m_s, aircraft.max_range_m, "m"),
    ]
    if crew.power_w is not None:
        limits.append(("energy", seconds * crew.power_w / 3600.0, aircraft.usable_wh, "Wh"))
    for rule, takes, most, unit in limits:
        if most is not None and takes > most:
            message = f"takes {name} {takes:.0f} {unit} there and home, and it has {most:.0f}"
            return Finding(name, rule, message, f"Give it {takes - most:.0f} {unit} more.")
    window = view.region.time_window_s
    if window is not None:
        ends_s = (out_m + inner_m) / model.airspeed_m_s + crew.besides_s / 2.0
        if ends_s > window[1]:
            message = (
                f"is over after {ends_s:.0f} s at the earliest, and the window closes at {window[1]:.0f} s"
            )
            return Finding(name, "window", message, f"Let it close {ends_s - window[1]:.0f} s later.")
    return None
