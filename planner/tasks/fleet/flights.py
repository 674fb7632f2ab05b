"""One flight of one aircraft: its jobs in the order that is shortest, or in a given one with waits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from planner.airspace.zones import TRANSIT_MARGIN_M, keep_out
from planner.dubins.path import Path
from planner.errors import InfeasibleError
from planner.fleet.waiting import Due, Timing, holds, least_hold_s, timing
from planner.metrics import used
from planner.profile.compose import Composed
from planner.progress import silent
from planner.publish import Leg
from planner.route import Anchor, CollectPass, Pose
from planner.tasks.collect import collect
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flown import Flown, Order
from planner.tasks.fleet.jobs import Job, as_asked, renamed
from planner.tasks.flying import Station
from planner.tasks.methods import chosen_methods
from planner.tasks.task import Controls
from planner.tasks.transits import Transits

#: Windows are kept with this to spare, half of which the fitting of circles may use.
SPARE_S = 0.5
#: Circles are fitted so often, until they take as long as is to be waited, to so much.
FITTINGS, WITHIN_S = 4, 0.1


def in_best_order(crew: Crew, number: int, jobs: Sequence[tuple[Job, int]], controls: Controls) -> Flown:
    """A flight whose jobs may be done at any time; in the order given where each is seen by itself alone.

    Raises
    ------
    InfeasibleError
        Where there is no such flight.
    """
    try:
        return _by_all_there_is(crew, number, jobs, controls)
    except InfeasibleError as error:
        if len(jobs) == 1:
            raise
        try:
            return _through(crew, number, jobs, _each_by_itself(crew, number, jobs, controls), (), controls)
        except InfeasibleError:
            raise error from None


def _by_all_there_is(crew: Crew, number: int, jobs: Sequence[tuple[Job, int]], controls: Controls) -> Flown:
    """As one aircraft that is asked for them alone."""
    regions = tuple(job.asked for job, _ in jobs)
    unlimited = replace(
        crew.alone.aircraft[0],
        energy_wh=None,
        max_range_m=None,
        max_flight_time_s=None,
    )
    alone = replace(crew.alone, regions=regions, aircraft=(unlimited,))
    answer = collect(alone, replace(controls, progress=silent))
    return _flown(
        crew, number, jobs, answer.composed, answer.legs, answer.passes, answer.notes, answer.methods
    )


def in_given_order(crew: Crew, number: int, jobs: Sequence[tuple[Job, int]], controls: Controls) -> Flown:
    """A flight in the order given whose jobs may be done at any time.

    Raises
    ------
    InfeasibleError
        Where there is no such flight.
    """
    try:
        with controls.stage("routing"):
            order = _chosen_together(crew, jobs)
        return _through(crew, number, jobs, order, (), controls)
    except InfeasibleError:
        # No line joins what was chosen by estimates, close to an edge or a zone: all that one has may.
        return in_best_order(crew, number, jobs, controls)


def by_passes(crew: Crew, number: int, passes: Sequence[CollectPass], controls: Controls) -> Flown:
    """A flight by passes in the order given, whatever they are of.

    Raises
    ------
    InfeasibleError
        Where no line leads from one to the next.
    """
    transits = Transits.of(crew.setting, crew.asked.objective, chosen_methods(crew.alone.method))
    with controls.stage("transit"):
        composed, legs, notes = transits.through(passes, silent, controls.stop)
    return _flown(crew, number, (), composed, legs, tuple(passes), notes, transits.methods)


def straight_home(crew: Crew, number: int, controls: Controls, wait_s: float = 0.0) -> Flown:
    """The flight of one that flies already and has nothing to do any more.

    Parameters
    ----------
    wait_s
        In circles where it is, before it goes; not where its course is not known.

    Raises
    ------
    InfeasibleError
        Where no line leads to its end, or there is no room for the circles.
    """
    start, level = crew.setting.ends[0], crew.setting.level
    here = Station(
        start.name,
        Anchor(*start.position, start.angle_rad),
        altitude_m=level.altitude_m - level.height_m + (start.over_home_m or 0.0),
    )
    if wait_s > 0.0 and start.angle_rad is not None:
        pose = Pose(*start.position, start.angle_rad)
        here = replace(here, hold=_circles(crew, pose, wait_s, start.name))
    transits = Transits.of(crew.setting, crew.asked.objective, chosen_methods(crew.alone.method))
    with controls.stage("transit"):
        composed, legs, notes = transits.by([here], silent, controls.stop)
    return _flown(crew, number, (), composed, legs, (), notes, transits.methods, ())


def in_order(crew: Crew, jobs: Sequence[tuple[Job, int]], controls: Controls) -> Order:
    """The passes of jobs in the order given, chosen together; each by itself where not all are seen so.

    Raises
    ------
    InfeasibleError
        Where one cannot be seen.
    """
    try:
        return _chosen_together(crew, jobs)
    except InfeasibleError:
        return _each_by_itself(crew, 0, jobs, controls)


def _chosen_together(crew: Crew, jobs: Sequence[tuple[Job, int]]) -> Order:
    numbers, owners = _numbered(crew, jobs)
    choice = crew.looks.refined(crew.ends, crew.around, numbers)
    if not math.isfinite(choice.cost_m):
        raise InfeasibleError(
            "transit", crew.aircraft.name, "no line leads through its regions in time", "Widen the windows."
        )
    tours = crew.looks.tours(crew.ends, crew.around)
    choice = tours.fitted(choice)
    passes: list[CollectPass] = []
    of: list[int] = []
    for owner, target, row in zip(owners, tours.visited(choice), choice.picked, strict=True):
        own_passes = target.passes(row, 0)
        passes.extend(own_passes)
        of.extend([owner] * len(own_passes))
    return Order(tuple(passes), tuple(of))


def thought_s(crew: Crew, jobs: Sequence[tuple[Job, int]]) -> float:
    """How long a flight takes in an order given over the ground, about; infinity where no line leads through.

    Raises
    ------
    InfeasibleError
        Where one cannot be seen.
    """
    return crew.thought_s(_numbered(crew, jobs)[0])


def _numbered(crew: Crew, jobs: Sequence[tuple[Job, int]]) -> tuple[list[int], list[int]]:
    """Of targets in the order of their jobs the numbers among the looks, and which job each is of."""
    numbers: list[int] = []
    owners: list[int] = []
    for place, (job, _) in enumerate(jobs):
        own = crew.seen(job)
        numbers.extend(own)
        owners.extend([place] * len(own))
    return numbers, owners


def with_waits(
    crew: Crew,
    number: int,
    jobs: Sequence[tuple[Job, int]],
    order: Order,
    bounds_s: Sequence[tuple[float, float]],
    ready_s: float,
    controls: Controls,
) -> tuple[Flown, Timing]:
    """A flight in a given order that waits where it would be early.

    Parameters
    ----------
    bounds_s
        Of each job on the plan's clock: when it may begin, and when it has to be over.
    ready_s
        When it may lift off; what flies already begins then, and waits in the air alone.

    Raises
    ------
    InfeasibleError
        Where there is no room to wait in.
    """
    try:
        plain = _through(crew, number, jobs, order, (), controls)
    except InfeasibleError:
        # As in ``in_given_order``; the order may not change for the times that are to be kept.
        order = _each_by_itself(crew, number, jobs, controls)
        plain = _through(crew, number, jobs, order, (), controls)
    held_s = least_hold_s(crew.setting.model)
    dues: list[Due] = []
    for (job, _), (start_s, end_s), (opens_s, closes_s) in zip(jobs, plain.spans_s, bounds_s, strict=True):
        before = [k for k in range(len(dues)) if jobs[k][0].region.name == job.region.name]
        apart_s = job.region.revisit_after_s + SPARE_S
        dues.append(Due(start_s, end_s, opens_s, closes_s, held_s, before[-1] if before else None, apart_s))
    when = timing(dues, ready_s, pinned=crew.aircraft.aloft is not None)
    if when.worst is not None or when.waited_s <= 0.0:
        return plain, when
    return _waited(crew, number, jobs, order, plain, dues, when, controls)


def _each_by_itself(crew: Crew, number: int, jobs: Sequence[tuple[Job, int]], controls: Controls) -> Order:
    """Of each job the passes that its aircraft flies for it alone, in the order given."""
    passes = [in_best_order(crew, number, [each], controls).order.passes for each in jobs]
    of = [place for place, own in enumerate(passes) for _ in own]
    return Order(tuple(each for own in passes for each in own), tuple(of))


def _waited(
    crew: Crew,
    number: int,
    jobs: Sequence[tuple[Job, int]],
    order: Order,
    plain: Flown,
    dues: Sequence[Due],
    when: Timing,
    controls: Controls,
) -> tuple[Flown, Timing]:
    """The flight with its circles, made wider or narrower until they take as long as is to be waited."""
    told_s = list(when.waits_s)
    flown = _through(crew, number, jobs, order, when.waits_s, controls, told_s)
    for _ in range(FITTINGS):
        took_s = _waits_of(flown, plain)
        off_s = max(abs(took - wanted) for took, wanted in zip(took_s, when.waits_s, strict=True))
        if off_s <= WITHIN_S:
            break
        told_s = [
            told * wanted / took if wanted > 0.0 and took > 0.0 else told
            for told, wanted, took in zip(told_s, when.waits_s, took_s, strict=True)
        ]
        flown = _through(crew, number, jobs, order, when.waits_s, controls, told_s)
    flown = replace(flown, waited_s=math.fsum(_waits_of(flown, plain)))
    late = [when.start_s + end_s - due.closes_s for (_, end_s), due in zip(flown.spans_s, dues, strict=True)]
    worst = max(range(len(late)), key=lambda k: late[k])
    if late[worst] > SPARE_S / 2.0:
        return flown, replace(when, late_s=late[worst], worst=worst)
    return flown, when


def _waits_of(flown: Flown, plain: Flown) -> list[float]:
    """How long a flight waits before each job, against one that does not wait."""
    later_s = [a[0] - b[0] for a, b in zip(flown.spans_s, plain.spans_s, strict=True)]
    return [now - before for now, before in zip(later_s, [0.0, *later_s], strict=False)]


def _through(
    crew: Crew,
    number: int,
    jobs: Sequence[tuple[Job, int]],
    order: Order,
    waits_s: Sequence[float],
    controls: Controls,
    told_s: Sequence[float] | None = None,
) -> Flown:
    # Of a part of a region, too, passes are at the altitude that its region asks for.
    named = [job.region for job, _ in jobs]
    setting = replace(
        crew.setting,
        altitudes_m={each.name: each.altitude_m for each in named if each.altitude_m is not None},
        over_ground_m={each.name: each.over_ground_m for each in named if each.over_ground_m is not None},
    )
    transits = Transits.of(setting, crew.asked.objective, chosen_methods(crew.alone.method))
    waiting: dict[int, Path] = {}
    for place, wait_s in enumerate(waits_s):
        if wait_s > 0.0:
            first = order.of.index(place)
            told = None if told_s is None else told_s[place]
            waiting[first] = _hold(crew, order.passes[first], wait_s, told)
    with controls.stage("transit"):
        composed, legs, notes = transits.through(order.passes, silent, controls.stop, waiting)
    return _flown(crew, number, jobs, composed, legs, order.passes, notes, transits.methods, order.of)


def _hold(crew: Crew, collect_pass: CollectPass, wait_s: float, told_s: float | None) -> Path:
    """Circles before a pass; raises as ``_circles``."""
    pose = collect_pass.settling(crew.setting.model.settle_m)
    return _circles(crew, pose, wait_s, "+".join(collect_pass.regions), told_s)


def _circles(crew: Crew, pose: Pose, wait_s: float, name: str, told_s: float | None = None) -> Path:
    """Circles back to a pose, on the side where there is room.

    Raises
    ------
    InfeasibleError
        Where there is none on either.
    """
    model, level = crew.setting.model, crew.setting.level
    zones = keep_out(crew.setting.airspace, level, TRANSIT_MARGIN_M)
    for circles in holds(pose, wait_s, model, told_s):
        if zones.clear(circles):
            return circles
    raise InfeasibleError(
        "window", name, f"there is no room to wait {wait_s:.0f} s before it", "Widen its time_window_s.",
        pose.position,
    )  # fmt: skip


def _flown(
    crew: Crew,
    number: int,
    jobs: Sequence[tuple[Job, int]],
    composed: Composed,
    legs: tuple[Leg, ...],
    passes: tuple[CollectPass, ...],
    notes: tuple[str, ...],
    methods: dict[str, str],
    of: Sequence[int] | None = None,
) -> Flown:
    only = [job for job, _ in jobs]
    spans: dict[int, tuple[float, float]] = {}
    firsts: list[int] = []
    for index, (each, (from_m, until_m)) in enumerate(zip(passes, composed.passes_m, strict=True)):
        begin_s, end_s = composed.flight.along(from_m)[1], composed.flight.along(until_m)[1]
        seen = (
            [place for place, job in enumerate(only) if job.region.name in each.regions]
            if of is None
            else [of[index]]
        )
        firsts.append(seen[0] if seen else -1)
        for place in seen:
            first_s, last_s = spans.get(place, (math.inf, 0.0))
            spans[place] = (min(first_s, begin_s), max(last_s, end_s))
    setting = crew.setting
    named = tuple(
        replace(leg, from_name=renamed(leg.from_name, only), to_name=renamed(leg.to_name, only))
        for leg in legs
    )
    return Flown(
        number,
        tuple(jobs),
        composed,
        named,
        as_asked(passes, only),
        notes,
        tuple(spans[place] for place in range(len(only))),
        used(composed.flight, setting.model, setting.level),
        methods,
        Order(tuple(passes), tuple(firsts)),
        ends=setting.ends,
    )
