"""What one aircraft is asked to search, what its limits allow, and how programmes of it are flown."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import shapely
from shapely.geometry import MultiPolygon, Polygon

from planner.errors import InfeasibleError
from planner.metrics import used
from planner.progress import never, silent
from planner.scenario import Scenario
from planner.search.belief.drifting import Drifting, believed
from planner.search.choose import Search
from planner.search.programme import Pricing, Programme
from planner.search.reached import ALL_OF_IT, reached
from planner.search.room import Room
from planner.search.swaths import Looking
from planner.tasks.budget import MOST, Flight, part_used
from planner.tasks.methods import chosen_methods
from planner.tasks.setting import Setting
from planner.tasks.spare import Spare, refuse_blocked, spare_of
from planner.tasks.task import Controls
from planner.tasks.transits import Transits
from planner.tasks.unflown import unflown_of
from planner.tasks.worth import drifted, ground_of, worth_of
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import exceeded

#: Cells of the worth of ground: so many to the swath's width, no more to a side, no finer.
CELLS_ACROSS, MOST_CELLS, LEAST_CELL_M = 8.0, 160, 0.5
#: A flight is flown in so many lengths.
LENGTHS = 6
#: A flight that uses this part of what it may is long enough.
ENOUGH = 0.99
#: An aircraft so near to a level is flying at it.
LEVEL_M = 1.0
#: A flight that nothing limits looks for what drifts for so many times what sees all ground once.
UNLIMITED = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Sought:
    """One aircraft's search, ranked and not yet flown.

    ``spare`` is what its limits allow.
    """

    setting: Setting
    transits: Transits
    asked: Search
    spare: Spare
    ranked: tuple[Programme, ...]


def unranked(scenario: Scenario, controls: Controls) -> Sought:
    """One aircraft's search with nothing of it tried yet.

    Raises
    ------
    InfeasibleError
        As for ``sought``.
    """
    setting = Setting.of(scenario)
    methods = chosen_methods(scenario.method) | {"search": "patterns", "coverage": "none", "routing": "none"}
    transits = Transits.of(setting, scenario.objective, methods)
    asked = replace(
        asked_of(scenario, setting), stop=controls.stop, enough=controls.enough, seed=scenario.seed
    )
    refuse_blocked(asked, *(terminal.name for terminal in setting.ends))
    spare = spare_of(transits, asked, controls.stop)
    if scenario.importance.drift is not None:
        asked = _drifting(asked, scenario, spare)
    return Sought(setting, transits, asked, spare, ())


def reach(scenario: Scenario, controls: Controls) -> tuple[float, float]:
    """Ground that an aircraft sees at most, flying straight as long as limits allow, and how long that is.

    Raises
    ------
    InfeasibleError
        Where it cannot come to its end, or sees nothing.
    """
    setting = Setting.of(scenario)
    asked = asked_of(scenario, setting)
    refuse_blocked(asked, *(terminal.name for terminal in setting.ends))
    transits = Transits.of(setting, scenario.objective, chosen_methods(scenario.method))
    spare = spare_of(transits, asked, controls.stop)
    return spare.metres * asked.looking.narrowest_m(), _lasting_s(asked, spare)


def flier_of(one: Sought, controls: Controls) -> Callable[[Programme], Flight]:
    """What flies programmes of a search, take-off and landing included."""
    setting, asked = one.setting, one.asked

    def fly(programme: Programme) -> Flight:
        passes = tuple(asked.looking.collect(s.start, s.end, s.look) for s in programme.sweeps)
        composed, legs, notes = one.transits.through(passes, silent, controls.stop)
        use = used(composed.flight, setting.model, setting.level)
        return Flight(programme, passes, composed, legs, notes, use)

    return fly


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
    refuse_blocked(asked, *(terminal.name for terminal in setting.ends))
    spare_of(transits, asked, never)


def asked_of(scenario: Scenario, setting: Setting) -> Search:
    """What one aircraft is asked to search, nothing of it tried yet."""
    regions = scenario.regions
    ground = ground_of(shapely.union_all([region.area for region in regions]))
    level = setting.level.of(regions[0])
    whole = ground if isinstance(ground, Polygon) else ground.convex_hull
    sensor, height_m = setting.suite.over(regions[0].sensor, ground_of(whole), setting.airspace, level)
    looking = Looking(sensor, height_m, tuple(region.name for region in regions))
    width_m = looking.narrowest_m()
    start, end = (terminal.position for terminal in setting.ends)
    # One that is in the air elsewhere than at the height of the search comes to that on its way.
    aloft_m = setting.ends[0].over_home_m
    level_with = aloft_m is None or abs(aloft_m - level.height_m) < LEVEL_M
    where = reached(setting.airspace, level, (start, end), ground) if level_with else ALL_OF_IT
    room = Room.of(setting.airspace, level, setting.model, scenario.objective, ground, where)
    worth = worth_of(scenario, ground, _cell_m(ground, width_m))
    family = None if scenario.method.search == "auto" else scenario.method.search
    detection = scenario.importance.detection
    pricing = Pricing(setting.model, start, end)
    kept = unflown_of(scenario, setting, looking)
    return Search(ground, worth, looking, room, pricing, family=family, detection=detection, kept=kept)


def _lasting_s(asked: Search, spare: Spare) -> float:
    """How long the flight lasts at most."""
    once_m = asked.ground.area / asked.looking.narrowest_m()
    return spare.lead_s + min(spare.metres, UNLIMITED * once_m) / asked.pricing.model.aircraft.airspeed_m_s


def _drifting(asked: Search, scenario: Scenario, spare: Spare) -> Search:
    """The search for what drifts: by places that move on, and by what ground is worth in the middle of it."""
    importance = scenario.importance
    if importance.drift is None:
        return asked
    until_s = _lasting_s(asked, spare)
    belief = believed(importance, importance.drift, seed=scenario.seed)
    if not belief.weights.any():
        raise InfeasibleError(
            "nothing-left",
            "search",
            "has looked already (seen) wherever what drifts may be, and a look finds all there is",
            "Lower detection, widen the importance, or leave out of seen what is to be looked at again.",
        )
    drifting = Drifting(belief, importance.detection, spare.lead_s, until_s).within(asked.ground)
    later = drifted(importance, 0.5 * until_s)
    worth = worth_of(replace(scenario, importance=later), asked.ground, asked.worth.cell_m)
    return replace(asked, worth=worth, drifting=drifting)


def _cell_m(ground: Polygon | MultiPolygon, width_m: float) -> float:
    west_m, south_m, east_m, north_m = ground.bounds
    side_m = max(east_m - west_m, north_m - south_m)
    return max(LEAST_CELL_M, side_m / MOST_CELLS, min(width_m / CELLS_ACROSS, side_m / 40.0))


def as_long_as_can_be(
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
