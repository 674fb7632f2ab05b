"""The task ``search`` for several aircraft or batteries: the ground shared out, each part searched by one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import affinity
from shapely.geometry import MultiPolygon, Polygon, box

from planner.errors import Finding, InfeasibleError
from planner.fleet.assignment import Trip
from planner.metrics import used
from planner.scenario import Scenario
from planner.search.choose import REFINED
from planner.search.seen import missed_before
from planner.search.values import Worth
from planner.tasks.fleet.aloft import homewards
from planner.tasks.fleet.answer import FleetAnswer
from planner.tasks.fleet.crews import Crew, crews_of
from planner.tasks.fleet.flown import Flown, Order
from planner.tasks.fleet.held import too_many_items
from planner.tasks.fleet.placing import Errand, placed
from planner.tasks.search import answer_to, answer_with, sought
from planner.tasks.sought import asked_of, reach, unranked
from planner.tasks.strips import moved_together
from planner.tasks.task import Answer, Controls
from planner.tasks.worth import drifted, ground_of, worth_of
from planner.wishes import Seen

#: Of what the one before may use, where all come home at once otherwise.
SHORTER = 0.85
#: Ends nearer to each other than this part of the ground's width say nothing of which part is whose.
APART = 0.1
#: The worth of ground is added up by cells, so many across all bands.
CELLS = 200
#: One after the other finds so many times as much as bands do, or bands are kept.
MUCH_BETTER = 1.01
Floats = NDArray[np.float64]
_NO_ROOM = InfeasibleError(
    "separation", "its line", "comes too near to the others' wherever it searches; it flies to its end",
    "Lower separation, or plan it anew later.",
)  # fmt: skip

_NOTHING_LEFT = InfeasibleError(
    "nothing-left", "its limits", "let it find no more than the others do; it flies to its end",
    "Raise its limits, or leave it more to see.",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Share:
    """One flight to come: whose it is, which of its aircraft's, and how much ground it sees at most."""

    crew: int
    number: int
    reach_m2: float


def search_together(scenario: Scenario, controls: Controls) -> FleetAnswer:
    """Who searches which part of the ground, and the flights that do it.

    The ground is cut into bands, each worth the more the more of it its flight can see. A flight that can do
    nothing in its band is left out, and the ground shared out anew.

    Raises
    ------
    InfeasibleError
        Where no aircraft can search anything.
    """
    seeing = tuple(aircraft for aircraft in scenario.aircraft if scenario.of_one(aircraft).regions)
    crews, grounded = crews_of(scenario, seeing)
    dropped: list[Finding] = list(grounded)
    shares: list[_Share] = []
    refused: InfeasibleError | None = None
    longest_s = 0.0
    with controls.stage("options"):
        for index, crew in enumerate(crews):
            try:
                seen_m2, lasts_s = reach(crew.alone, controls)
            except InfeasibleError as error:
                refused = error
                dropped.append(_stays(crew, error))
                continue
            longest_s = max(longest_s, lasts_s)
            shares += [_Share(index, number, seen_m2) for number in range(crew.aircraft.batteries)]
    answers = _moved(scenario, crews, shares, controls) or {}
    while shares and not answers:
        # What drifts is shared out as it lies in the middle of the longest flight.
        later = replace(scenario, importance=drifted(scenario.importance, 0.5 * longest_s))
        parts = shared_out(later, crews, shares)
        for number, (share, part) in enumerate(zip(shares, parts, strict=True)):
            own = replace(controls, enough=controls.enough.part(1.0 / (len(parts) - number)))
            crew = crews[share.crew]
            alone = _within(crew.alone, part)
            try:
                if not alone.regions:
                    raise InfeasibleError("blocked", crew.aircraft.name, "has no ground left to search", "")
                answers[share] = answer_to(sought(alone, own), own)
            except InfeasibleError as error:
                refused = error
                shares = [each for each in shares if each != share]
                dropped.append(_stays(crew, error))
                answers = {}
                break
    if not answers:
        raise refused or InfeasibleError(
            "sensor", "scenario", "no aircraft has a sensor on board to search with",
            "Add a sensor to the sensors of a vehicle.",
        )  # fmt: skip
    ways = [answers]
    if any(crew.aircraft.aloft is not None for crew in crews):
        # Bands do not lie as those lie that are in the air already.
        shares = list(answers)
        turns = [
            _in_turn(crews, order, controls) for order in (shares, shares[::-1]) if not controls.enough()
        ]
        ways = _best_first(scenario, [*_as_before(crews, shares, controls), answers, *turns])
        # Flights that are as long come home together.
        for order in () if controls.enough() else (shares, shares[::-1]):
            shorter = _in_turn(crews, order, controls, shorter=SHORTER)
            ways += [] if shorter is None else [shorter]
        # Where none of that keeps them apart, fewer search, and the others fly to their ends.
        ways += [dict(list(answers.items())[:many]) for many in range(len(answers) - 1, 0, -1)]
    separation = scenario.kept_apart
    for number, answers in enumerate(ways):
        flown = {share: _flown(crews[share.crew], share, answer) for share, answer in answers.items()}
        errands = [Errand(_trip(share, flown[share]), (), flown[share]) for share in answers]
        trips = [errand.trip for errand in errands]
        try:
            errands += [Errand(trip, (), home) for trip, home in homewards(crews, trips, controls)]
            with controls.stage("separation"):
                sorties = placed(crews, errands, separation, controls, scenario.seed)
            break
        except InfeasibleError:
            if number == len(ways) - 1:
                raise
    idle = [share for share in shares if share not in answers]
    dropped += [_stays(crews[share.crew], _NO_ROOM if share in ways[0] else _NOTHING_LEFT) for share in idle]
    dropped += [told for sortie in sorties for told in too_many_items(crews, sortie.flown)]
    families = dict.fromkeys(answer.methods["search"] for answer in answers.values())
    methods = next(iter(answers.values())).methods | {"search": "+".join(families)}
    return FleetAnswer(crews, sorties, methods, tuple(dict.fromkeys(dropped)), (), separation)


def _moved(
    scenario: Scenario, crews: Sequence[Crew], shares: Sequence[_Share], controls: Controls
) -> dict[_Share, Answer] | None:
    """Strips of all flights moved together over all the ground; None where that is not to be done so."""
    alone = [crews[share.crew].alone for share in shares]
    names = {tuple(region.name for region in each.regions) for each in alone}
    if (
        len(shares) < 2
        or len(names) > 1
        or scenario.method.search not in ("auto", REFINED)
        or scenario.importance.drift is not None
        or any(crew.aircraft.aloft is not None for crew in crews)
    ):
        return None
    ones = []
    try:
        for each in alone:
            ones.append(unranked(each, controls))
    except InfeasibleError:
        # Who stays at home is found by bands.
        return None
    flights = moved_together(alone[0], ones, controls)
    if flights is None:
        return None
    return {s: answer_with(one, best) for s, one, best in zip(shares, ones, flights, strict=True)}


def _best_first(
    scenario: Scenario, ways: Sequence[dict[_Share, Answer] | None]
) -> list[dict[_Share, Answer]]:
    """Ways by what they find, but for those of which one before finds nearly as much."""
    found: list[tuple[float, dict[_Share, Answer]]] = []
    for way in ways:
        if way is None:
            continue
        worth = _found(scenario, way)
        place = sum(other * MUCH_BETTER >= worth for other, _ in found)
        found.insert(place, (worth, way))
    return [way for _, way in found]


def _as_before(
    crews: Sequence[Crew], shares: Sequence[_Share], controls: Controls
) -> list[dict[_Share, Answer] | None]:
    """What each was still to fly, improved over all that the others leave; and as it was."""
    going_on = crews[shares[0].crew].alone.going_on
    if going_on is None or not all(crews[share.crew].aircraft.name in going_on.unflown for share in shares):
        return []
    looks = {share: _looks_to_come(crews[share.crew]) for share in shares}
    found = []
    for improved in (True, False):
        found.append(_in_turn(crews, shares, controls, looks, improved=improved))
    return found


def _looks_to_come(crew: Crew) -> list[Seen]:
    """What an aircraft was still to see."""
    going_on = crew.alone.going_on
    looking = asked_of(crew.alone, crew.setting).looking
    passes = () if going_on is None else going_on.unflown.get(crew.aircraft.name, ())
    return [Seen(looking.collect(one.start, one.end, one.look).footprint) for one in passes]


def _in_turn(
    crews: Sequence[Crew],
    shares: Sequence[_Share],
    controls: Controls,
    to_come: Mapping[_Share, Sequence[Seen]] | None = None,
    *,
    improved: bool = True,
    shorter: float = 1.0,
) -> dict[_Share, Answer] | None:
    """Each over all that those before it leave; None where none can do anything of that, or it drifts.

    ``to_come`` is what each was still to see: each then begins with its own, and leaves the others theirs.
    Each is planned with this part of what the one before may use of its limits.
    """
    answers: dict[_Share, Answer] = {}
    looks: list[Seen] = []
    for number, share in enumerate(shares):
        own = replace(controls, enough=controls.enough.part(1.0 / (len(shares) - number)))
        later = [look for other in shares[number + 1 :] for look in (to_come or {}).get(other, ())]
        alone = _after(_limited(crews[share.crew].alone, shorter**number), [*looks, *later])
        if to_come is None:
            alone = replace(alone, going_on=None)
        if alone.importance.drift is not None:
            return None
        try:
            if not alone.regions:
                continue
            one = sought(alone, own, as_before=to_come is not None)
            answers[share] = answer_to(one, own, improved=improved)
        except InfeasibleError:
            # It has nothing to do that it can; others may.
            continue
        looks += [Seen(each.footprint) for each in answers[share].passes]
    return answers or None


def _limited(alone: Scenario, part: float) -> Scenario:
    """With this part of what its aircraft may use."""
    limits = ("energy_wh", "max_range_m", "max_flight_time_s")
    fleet = [
        replace(each, **{name: part * value for name in limits if (value := getattr(each, name)) is not None})
        for each in alone.aircraft
    ]
    return alone if part == 1.0 else replace(alone, aircraft=tuple(fleet))


def _after(alone: Scenario, looks: Sequence[Seen]) -> Scenario:
    """What an aircraft is asked when others have looked."""
    importance = replace(alone.importance, seen=(*alone.importance.seen, *looks))
    if importance.detection < 1.0:
        return replace(alone, importance=importance)
    seen = shapely.union_all([look.area for look in looks])
    left = [(region, ground_of(shapely.difference(region.area, seen))) for region in alone.regions]
    return replace(alone, regions=tuple(replace(r, area=area) for r, area in left if not area.is_empty))


def _found(scenario: Scenario, answers: Mapping[_Share, Answer]) -> float:
    """What all looks together find of the ground's worth, by cells."""
    ground = ground_of(shapely.union_all([region.area for region in scenario.regions]))
    west, south, east, north = ground.bounds
    worth = worth_of(scenario, ground, max(east - west, north - south) / CELLS)
    looks = tuple(Seen(each.footprint) for answer in answers.values() for each in answer.passes)
    left = missed_before(replace(scenario.importance, seen=looks), worth.centres_m)
    return float((worth.scores * (1.0 - left)).sum())


def shared_out(
    scenario: Scenario, crews: Sequence[Crew], shares: Sequence[_Share]
) -> list[Polygon | MultiPolygon]:
    """The ground in bands, worth as much as each flight can see of it, one for each in turn.

    Bands lie one beside the other as the aircraft's bases do; where all start at one place they run along
    the ground's length.
    """
    ground = ground_of(shapely.union_all([region.area for region in scenario.regions]))
    if len(shares) == 1:
        return [ground]
    bases = np.array([crews[share.crew].setting.ends[0].position for share in shares])
    angle_rad = _stacked_rad(ground, bases)
    across = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    # Those of one place in the order given: of one aircraft one beside the other.
    order = np.lexsort((np.arange(len(shares)), np.round(bases @ across, 3)))
    # What can see all of it has as much as any other that can.
    sizes_m2 = np.minimum([share.reach_m2 for share in shares], ground.area)[order]
    ends = np.cumsum(sizes_m2)[:-1] / sizes_m2.sum()
    turned = affinity.rotate(ground, -angle_rad, origin=(0.0, 0.0), use_radians=True)
    west, south, east, north = turned.bounds
    inner = _marks(worth_of(scenario, ground, (east - west) / CELLS), across, ends)
    marks = [west, *np.clip(inner, west, east).tolist(), east]
    found: list[Polygon | MultiPolygon] = [ground] * len(shares)
    for place, (low, high) in zip(order.tolist(), pairwise(marks), strict=True):
        band = turned.intersection(box(low, south - 1.0, high, north + 1.0))
        found[place] = ground_of(affinity.rotate(band, angle_rad, origin=(0.0, 0.0), use_radians=True))
    return found


def _marks(worth: Worth, across: Floats, ends: Floats) -> Floats:
    """Distances along a direction before which these parts of all worth lie."""
    scores = worth.scores.ravel()
    along_m = worth.centres_m.reshape(-1, 2) @ across
    order = np.argsort(along_m, kind="stable")
    before = np.cumsum(scores[order]) / scores.sum()
    return np.interp(ends, before, along_m[order])


def _stacked_rad(ground: Polygon | MultiPolygon, bases: Floats) -> float:
    """The direction in which bands follow each other."""
    west, south, east, north = ground.bounds
    off = bases - bases.mean(axis=0)
    if float(np.hypot(*off.T).max()) > APART * math.hypot(east - west, north - south):
        _, _, ways = np.linalg.svd(off)
        return math.atan2(ways[0, 1], ways[0, 0])
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(ground))[:3]
    sides = np.diff(corners, axis=0)
    shortest = sides[int(np.argmin(np.hypot(*sides.T)))]
    return math.atan2(shortest[1], shortest[0])


def _within(alone: Scenario, part: Polygon | MultiPolygon) -> Scenario:
    """What an aircraft is asked of its part of the ground."""
    cut = [(region, ground_of(region.area.intersection(part))) for region in alone.regions]
    regions = tuple(replace(region, area=area) for region, area in cut if not area.is_empty)
    return replace(alone, regions=regions)


def _stays(crew: Crew, error: InfeasibleError) -> Finding:
    said = f"does not search: {error.feature} {error.message}"
    return Finding(crew.aircraft.name, f"not-flown-{error.constraint}", said, error.relaxation, "warning")


def _flown(crew: Crew, share: _Share, answer: Answer) -> Flown:
    setting = crew.setting
    use = used(answer.composed.flight, setting.model, setting.level)
    return Flown(
        share.crew, (), answer.composed, answer.legs, answer.passes, answer.notes, (), use, answer.methods,
        Order(answer.passes, ()),
    )  # fmt: skip


def _trip(share: _Share, flown: Flown) -> Trip:
    # Of the times of a search nothing is asked: an aircraft's flights follow each other in their order.
    begin_s = float(share.number)
    use = flown.use
    return Trip(
        share.crew, share.crew, share.crew, begin_s, begin_s + flown.duration_s, (),
        use.length_m, use.energy_wh or 0.0, 0.0,
    )  # fmt: skip
