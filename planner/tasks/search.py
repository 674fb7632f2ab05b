"""The task ``search``: see as much ground, or importance, as the energy allows, and end at the end."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from planner.airspace.zones import AREA
from planner.errors import InfeasibleError
from planner.metrics import used
from planner.progress import silent
from planner.route import Anchor
from planner.scenario import Scenario
from planner.search.belief.drifting import Drifting, believed
from planner.search.choose import PUBLISHED, REFINED, Search
from planner.search.programme import Pricing, Programme
from planner.search.room import Room
from planner.search.swaths import Looking
from planner.tasks.budget import MOST, Flight, limits_of, part_used, per_m_of
from planner.tasks.flying import Station
from planner.tasks.leftover import filled
from planner.tasks.methods import chosen_methods
from planner.tasks.setting import Setting
from planner.tasks.task import Answer, Controls, Task
from planner.tasks.transits import Transits
from planner.tasks.worth import drifted, ground_of, worth_of
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import exceeded

#: Cells of the worth of ground: so many to the swath's width, no more to a side, no finer.
CELLS_ACROSS, MOST_CELLS, LEAST_CELL_M = 8.0, 160, 0.5
#: So many of the best programmes are flown, each in so many lengths.
FLOWN, LENGTHS = 6, 6
#: A flight that uses this part of what it may is long enough.
ENOUGH = 0.99
#: The best flight is improved so often, for so much more at least.
MOST_IMPROVED, LEAST_BETTER = 3, 1e-3
#: A flight that nothing limits looks for what drifts for so many times what sees all ground once.
UNLIMITED = 1.5
#: So much of what blocks is named.
NAMED = 5
#: Ends no farther apart are one place to what hovers, which flies this far at least.
HOVERED_M = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class Sought:
    """One aircraft's search, ranked and not yet flown.

    ``spare_m`` is what its limits allow, metres through the air.
    """

    setting: Setting
    transits: Transits
    asked: Search
    spare_m: float
    ranked: tuple[Programme, ...]


def search(scenario: Scenario, controls: Controls) -> Answer:
    """The flight that sees most, and ends at the end with its reserve."""
    return answer_to(sought(scenario, controls), controls)


def reach(scenario: Scenario, controls: Controls) -> tuple[float, float]:
    """Ground that an aircraft sees at most, flying straight as long as limits allow, and how long that is.

    Raises
    ------
    InfeasibleError
        Where it cannot come to its end, or sees nothing.
    """
    setting = Setting.of(scenario)
    asked = asked_of(scenario, setting)
    if next(asked.flyable(), None) is None:
        _refuse_blocked(asked, math.inf, setting.model.aircraft)
    transits = Transits.of(setting, scenario.objective, chosen_methods(scenario.method))
    spare_m, lead_s = _spare(transits, scenario, controls)
    return spare_m * asked.looking.narrowest_m(), _lasting_s(asked, spare_m, lead_s)


def sought(scenario: Scenario, controls: Controls) -> Sought:
    """What one aircraft may fly, that which sees most first.

    Raises
    ------
    InfeasibleError
        Where it can see nothing, or not come to its end.
    """
    setting = Setting.of(scenario)
    methods = chosen_methods(scenario.method) | {"search": "patterns", "coverage": "none", "routing": "none"}
    transits = Transits.of(setting, scenario.objective, methods)
    asked = replace(asked_of(scenario, setting), stop=controls.stop, seed=scenario.seed)
    spare_m, lead_s = _spare(transits, scenario, controls)
    if scenario.importance.drift is not None:
        asked = _drifting(asked, scenario, spare_m, lead_s)
    with controls.stage("search"):
        controls.progress("search", 0.0)
        ranked = asked.ranked(spare_m)
        if not ranked:
            _refuse_blocked(asked, spare_m, setting.model.aircraft)
    return Sought(setting, transits, asked, spare_m, tuple(ranked))


def answer_to(one: Sought, controls: Controls) -> Answer:
    """The best of what was ranked, flown as long as the limits allow.

    Raises
    ------
    InfeasibleError
        Where none of it can be flown.
    """
    setting, asked = one.setting, one.asked

    def fly(programme: Programme) -> Flight:
        passes = tuple(asked.looking.collect(s.start, s.end, s.look) for s in programme.sweeps)
        composed, legs, notes = one.transits.through(passes, silent, controls.stop)
        use = used(composed.flight, setting.model, setting.level)
        return Flight(programme, passes, composed, legs, notes, use)

    with controls.stage("transit"):
        best = _best(one.ranked, asked, one.spare_m, fly, setting.model.aircraft, controls)
        if asked.family in (None, REFINED) and best.programme.family not in PUBLISHED:
            best = _improved(best, asked, fly, setting.model.aircraft, controls)
            best = filled(best, asked, fly, setting.model.aircraft, controls.enough)
    methods = one.transits.methods | {"search": best.programme.family}
    return Answer(setting, best.composed, best.legs, best.passes, methods, (), best.notes)


def refuse_unsearchable(scenario: Scenario) -> None:
    """Refuse a search that sees nothing, or cannot come to its end.

    Raises
    ------
    InfeasibleError
        With the constraint, and of limits with the shortfall.
    """
    setting = Setting.of(scenario)
    transits = Transits.of(setting, scenario.objective, chosen_methods(scenario.method))
    asked = asked_of(scenario, setting)
    if next(asked.flyable(), None) is None:
        _refuse_blocked(asked, math.inf, setting.model.aircraft)
    _spare(transits, scenario, None)


def asked_of(scenario: Scenario, setting: Setting) -> Search:
    """What one aircraft is asked to search, nothing of it tried yet."""
    regions = scenario.regions
    ground = ground_of(shapely.union_all([region.area for region in regions]))
    level = setting.level.of(regions[0])
    whole = ground if isinstance(ground, Polygon) else ground.convex_hull
    sensor, height_m = setting.suite.over(regions[0].sensor, ground_of(whole), setting.airspace, level)
    looking = Looking(sensor, height_m, tuple(region.name for region in regions))
    width_m = looking.narrowest_m()
    room = Room.of(setting.airspace, level, setting.model, scenario.objective, ground)
    start, end = (terminal.position for terminal in setting.ends)
    worth = worth_of(scenario, ground, _cell_m(ground, width_m))
    family = None if scenario.method.search == "auto" else scenario.method.search
    detection = scenario.importance.detection
    pricing = Pricing(setting.model, start, end)
    return Search(ground, worth, looking, room, pricing, family=family, detection=detection)


def _lasting_s(asked: Search, spare_m: float, lead_s: float) -> float:
    """How long the flight lasts at most."""
    once_m = asked.ground.area / asked.looking.narrowest_m()
    return lead_s + min(spare_m, UNLIMITED * once_m) / asked.pricing.model.aircraft.airspeed_m_s


def _drifting(asked: Search, scenario: Scenario, spare_m: float, lead_s: float) -> Search:
    """The search for what drifts: by places that move on, and by what ground is worth in the middle of it."""
    importance = scenario.importance
    if importance.drift is None:
        return asked
    until_s = _lasting_s(asked, spare_m, lead_s)
    belief = believed(importance, importance.drift, seed=scenario.seed)
    if not belief.weights.any():
        raise InfeasibleError(
            "nothing-left",
            "search",
            "has looked already (seen) wherever what drifts may be, and a look finds all there is",
            "Lower detection, widen the importance, or leave out of seen what is to be looked at again.",
        )
    drifting = Drifting(belief, importance.detection, lead_s, until_s).within(asked.ground)
    later = drifted(importance, 0.5 * until_s)
    worth = worth_of(replace(scenario, importance=later), asked.ground, asked.worth.cell_m)
    return replace(asked, worth=worth, drifting=drifting)


def _cell_m(ground: Polygon | MultiPolygon, width_m: float) -> float:
    west_m, south_m, east_m, north_m = ground.bounds
    side_m = max(east_m - west_m, north_m - south_m)
    return max(LEAST_CELL_M, side_m / MOST_CELLS, min(width_m / CELLS_ACROSS, side_m / 40.0))


def _spare(transits: Transits, scenario: Scenario, controls: Controls | None) -> tuple[float, float]:
    """Metres through the air that limits allow from start to end, and seconds of what is before them.

    The metres are inf where nothing limits them; the seconds are half of what take-off and landing last.

    Raises
    ------
    InfeasibleError
        Where the flight to the end alone is over a limit, with the shortfall.
    """
    setting = transits.setting
    aircraft, (start, end) = setting.model.aircraft, setting.ends
    stop = (lambda: False) if controls is None else controls.stop
    over = Station(end.name, Anchor(*_over_end(scenario, setting)))
    try:
        composed, _, _ = transits.by((over,), silent, stop)
    except InfeasibleError as error:
        if error.constraint != AREA:
            raise
        raise InfeasibleError(
            AREA,
            start.name,
            f"has no room in the area for its flight's ends, of turns of {setting.model.turn_radius_m:.0f} m "
            f"in this wind, from {start.name} to {end.name}: {error.message}",
            "Start and end farther from the area's edge, widen it, or fly with tighter turns.",
            error.where_enu_m,
        ) from error
    use = used(composed.flight, setting.model, setting.level)
    per_m = per_m_of(aircraft, setting.level.amsl_m)
    for name, (taken, limit, unit) in limits_of(aircraft, use).items():
        if taken > limit:
            short = taken - limit
            metres = f", {short / per_m[name]:.0f} m of flight" if unit != "m" and per_m[name] > 0.0 else ""
            raise InfeasibleError(
                name,
                aircraft.name,
                f"the flight from {start.name} to {end.name} alone takes {taken:.1f} {unit}, there are "
                f"{limit:.1f} {unit}: {short:.1f} {unit} short{metres}",
                "Raise the limit, lower the reserve, or end nearer to the start.",
                end.position,
            )
    spare = [
        (limit - taken) / per_m[name]
        for name, (taken, limit, _) in limits_of(aircraft, use).items()
        if per_m[name] > 0.0
    ]
    away_m = math.dist(start.position, end.position)
    lead_s = 0.5 * max(0.0, use.duration_s - away_m / aircraft.airspeed_m_s)
    return min(spare, default=math.inf) + away_m, lead_s


def _over_end(scenario: Scenario, setting: Setting) -> tuple[float, float]:
    """Where the shortest flight leads: over its end; of what hovers there already a little way off."""
    (start, end), area = (terminal.position for terminal in setting.ends), scenario.regions[0].area
    if not setting.model.aircraft.hovers or math.dist(start, end) > HOVERED_M:
        return end
    inward = np.subtract(area.representative_point().coords[0], end)
    east_m, north_m = np.array(end) + inward * min(1.0, HOVERED_M / max(float(np.hypot(*inward)), HOVERED_M))
    return (float(east_m), float(north_m))


def _refuse_blocked(asked: Search, spare_m: float, aircraft: Aircraft) -> None:
    """Nothing can be seen: because nothing may be flown over it, or because that is too far."""
    name = asked.looking.names[0]
    place = asked.ground.representative_point()
    where = (float(place.x), float(place.y))
    if next(asked.flyable(), None) is None:
        blocking = asked.room.blocking(asked.ground)
        listed = ", ".join(blocking[:NAMED]) + (
            f" and {len(blocking) - NAMED} more" * (len(blocking) > NAMED)
        )
        raise InfeasibleError(
            "blocked",
            name,
            f"nothing of it can be seen: {listed or 'its shape'} and turns of "
            f"{asked.room.radius_m:.0f} m leave no pass over it from {asked.looking.height_m:.0f} m",
            "Widen the area, move what blocks it, or fly at another altitude or with tighter turns.",
            where,
        )
    away_m = min(asked.pricing.cost_m(way[:1]) for way in asked.flyable())
    raise InfeasibleError(
        "energy",
        aircraft.name,
        f"reaches none of the ground and its end: there and back are {away_m:.0f} m, its limits allow "
        f"{spare_m:.0f} m: {away_m - spare_m:.0f} m short",
        "Raise the limit, lower the reserve, or start nearer.",
        where,
    )


def _best(
    ranked: Sequence[Programme],
    asked: Search,
    spare_m: float,
    fly: Callable[[Programme], Flight],
    aircraft: Aircraft,
    controls: Controls,
) -> Flight:
    """The best programmes flown, each as long as the limits allow; the one that sees most."""
    best: Flight | None = None
    refused: InfeasibleError | None = None
    flown = 0
    for programme in ranked:
        if flown >= FLOWN or (best is not None and controls.enough()):
            break
        controls.progress("transit", flown / FLOWN)
        try:
            found = _as_long_as_can_be(programme, asked, spare_m, fly, aircraft)
        except InfeasibleError as error:
            refused = error
            continue
        flown += 1
        if found is not None and (best is None or found.programme.worth > best.programme.worth):
            best = found
    if best is not None:
        return best
    if refused is not None:
        raise refused
    _refuse_blocked(asked, spare_m, aircraft)
    raise AssertionError


def _improved(
    best: Flight,
    asked: Search,
    fly: Callable[[Programme], Flight],
    aircraft: Aircraft,
    controls: Controls,
) -> Flight:
    """The best flight's strips moved each by itself for as long as what is then flown sees more."""
    for _ in range(MOST_IMPROVED):
        if controls.enough():
            break
        # What was left over is given to the passes.
        budget_m = best.programme.cost_m * max(1.0, MOST / max(part_used(aircraft, best.use), 1e-9))
        better = asked.shifted(best.programme, budget_m)
        if better.worth <= best.programme.worth * (1.0 + LEAST_BETTER):
            break
        try:
            found = _as_long_as_can_be(better, asked, budget_m, fly, aircraft)
        except InfeasibleError:
            break
        if found is None or found.programme.worth <= best.programme.worth:
            break
        best = found
    return best


def _as_long_as_can_be(
    programme: Programme,
    asked: Search,
    spare_m: float,
    fly: Callable[[Programme], Flight],
    aircraft: Aircraft,
) -> Flight | None:
    """A programme cut to what limits allow of the flight itself, halving between too long and too short."""
    best: Flight | None = None
    short_m, long_m, budget_m = 0.0, math.inf, spare_m
    for _ in range(LENGTHS):
        flight = fly(programme)
        part = part_used(aircraft, flight.use)
        if part <= MOST and not exceeded(aircraft, flight.use):
            if best is None or flight.programme.worth >= best.programme.worth:
                best = flight
            short_m = budget_m
            if part >= ENOUGH or programme.sweeps == programme.whole:
                break
        else:
            # What it was thought to take, where that is less than it might: the same is cut again otherwise.
            long_m = budget_m = min(budget_m, programme.cost_m)
        wanted_m = budget_m * (0.5 * (MOST + ENOUGH)) / part if part > 0.0 else budget_m
        inside = short_m < wanted_m < long_m
        budget_m = wanted_m if inside else 0.5 * (short_m + min(long_m, 2.0 * budget_m))
        cut = asked.recut(programme, budget_m)
        if cut is None:
            break
        programme = cut
    return best


SEARCH = Task(search, None)
