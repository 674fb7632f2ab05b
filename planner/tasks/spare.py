"""What limits leave a search for, and what is said where that is nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Point
from shapely.ops import nearest_points

from planner.airspace.zones import AREA
from planner.errors import InfeasibleError
from planner.metrics import used
from planner.profile.compose import Composed
from planner.progress import Stop, silent
from planner.route import Anchor
from planner.search.choose import Search
from planner.search.room import Room
from planner.tasks.budget import MOST, limits_of, per_m_of
from planner.tasks.flying import Station
from planner.tasks.transits import Transits
from planner.vehicle.limits import Use, raised

#: Ends no farther apart are one place to what hovers, which flies this far at least.
HOVERED_M = 5.0
#: So much of what blocks is named; ground of which this part is barred is.
NAMED, ALL = 5, 1.0 - 1e-6
#: No word is lost on less of the ground than this.
LEAST_TOLD = 1e-3


@dataclass(frozen=True, slots=True)
class Spare:
    """What limits allow between start and end.

    Parameters
    ----------
    metres
        Through the air; inf where nothing limits them.
    lead_s
        Half of what take-off and landing last.
    limit, taken
        The limit that binds, and what the flight from start to end alone takes of it; None without limits.
    per_m
        What a metre more takes of it.
    """

    metres: float
    lead_s: float
    limit: str | None = None
    taken: float = 0.0
    per_m: float = 0.0


def spare_of(transits: Transits, asked: Search, stop: Stop) -> Spare:
    """What the limits of an aircraft leave it to search with.

    Raises
    ------
    InfeasibleError
        Where the flight to the end alone is over a limit, with the shortfall and what would do.
    """
    setting = transits.setting
    aircraft, (start, end) = setting.model.aircraft, setting.ends
    try:
        composed = _shortest(transits, asked.room, _over_end(transits, asked), stop)
    except InfeasibleError as error:
        if error.constraint == "hard-zone":
            raise InfeasibleError(
                "hard-zone",
                end.name,
                f"no flight leads there from {start.name}: {error.feature}: {error.message}",
                f"Move {end.name}, or what of {error.feature} and its neighbours is in the way.",
                error.where_enu_m,
            ) from error
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
    away_m = math.dist(start.position, end.position)
    limits = limits_of(aircraft, use)
    lead_s = 0.5 * max(0.0, use.duration_s - away_m / aircraft.airspeed_m_s)
    spare = [
        ((limit - taken) / per_m[name], name, taken)
        for name, (taken, limit, _) in limits.items()
        if per_m[name] > 0.0
    ]
    left_m, binding, taken = min(spare, default=(math.inf, None, 0.0))
    found = Spare(left_m + away_m, lead_s, binding, taken, per_m.get(binding or "", 0.0))
    if binding is not None and left_m < 0.0:
        _, limit, unit = limits[binding]
        wanted, way_m = _wanted(transits, asked, found, stop)
        if wanted <= limit:
            # On to its end by a pass is shorter than straight there: turns at both ends may be in the way.
            return replace(found, metres=way_m + (limit - wanted) / found.per_m)
        would_do = raised(aircraft, binding, max(wanted, taken / MOST))
        raise InfeasibleError(
            binding,
            aircraft.name,
            f"the flight from {start.name} to {end.name} alone takes {taken:.1f} {unit}, there are "
            f"{limit:.1f} {unit}: {_short(taken, limit, unit, found)}",
            f"{would_do}, or end nearer to the start.",
            end.position,
        )
    return found


def out_of_reach(transits: Transits, asked: Search, spare: Spare, stop: Stop) -> InfeasibleError:
    """The refusal of ground that limits do not reach, with what is missing and what would do."""
    aircraft, (start, end) = asked.pricing.model.aircraft, transits.setting.ends
    place = asked.ground.representative_point()
    name = spare.limit or "range"
    wanted, _ = _wanted(transits, asked, spare, stop)
    _, limit, unit = limits_of(aircraft, Use(0.0, 0.0, 0.0))[name]
    return InfeasibleError(
        name,
        aircraft.name,
        f"reaches none of the ground on its way from {start.name} to {end.name}: the shortest flight that "
        f"does takes {wanted:.1f} {unit}, there are {limit:.1f} {unit}: {_short(wanted, limit, unit, spare)}",
        f"{raised(aircraft, name, wanted)}, or start nearer.",
        (float(place.x), float(place.y)),
    )


def _short(taken: float, limit: float, unit: str, spare: Spare) -> str:
    """By how much a limit is exceeded, and what way that is."""
    short = taken - limit
    return f"{short:.1f} {unit} short" + f", {short / spare.per_m:.0f} m of flight" * (unit != "m")


def _wanted(transits: Transits, asked: Search, spare: Spare, stop: Stop) -> tuple[float, float]:
    """What a flight takes at least of the limit that binds to see something of the ground, by being flown.

    And what its way is thought to be, metres through the air.
    """
    setting, name = transits.setting, spare.limit or "range"
    found = []
    nearest = asked.nearest()
    for way in nearest:
        (sweep,) = way.sweeps
        collect = asked.looking.collect(sweep.start, sweep.end, sweep.look)
        try:
            composed = transits.through((collect,), silent, stop)[0]
        except InfeasibleError:
            continue
        use = used(composed.flight, setting.model, setting.level)
        found.append((limits_of(setting.model.aircraft, use)[name][0] / MOST, way.cost_m))
    away_m = math.dist(asked.pricing.start, asked.pricing.end)
    thought = spare.taken + (nearest[0].cost_m - away_m) * spare.per_m
    return min(found, default=(thought / MOST, nearest[0].cost_m))


def _shortest(transits: Transits, room: Room, over_m: tuple[float, float], stop: Stop) -> Composed:
    """From start to end by a place over the end; by the nearest one with room to turn where that is none."""
    name = transits.setting.ends[1].name
    try:
        return transits.by((Station(name, Anchor(*over_m)),), silent, stop)[0]
    except InfeasibleError as first:
        roomy = room.turning.buffer(-room.radius_m)
        if roomy.is_empty:
            raise
        place, _ = nearest_points(roomy, Point(over_m))
        try:
            return transits.by((Station(name, Anchor(place.x, place.y)),), silent, stop)[0]
        except InfeasibleError:
            raise first from None


def _over_end(transits: Transits, asked: Search) -> tuple[float, float]:
    """Where the shortest flight leads: over its end; of what hovers there already a little way off."""
    start, end = (terminal.position for terminal in transits.setting.ends)
    if not transits.setting.model.aircraft.hovers or math.dist(start, end) > HOVERED_M:
        return end
    inward = np.subtract(asked.ground.representative_point().coords[0], end)
    east_m, north_m = np.array(end) + inward * min(1.0, HOVERED_M / max(float(np.hypot(*inward)), HOVERED_M))
    return (float(east_m), float(north_m))


def refuse_blocked(asked: Search, start: str, end: str) -> None:
    """Refuse an end that no flight leads to; ground so, that nothing may be flown over, or that no pass sees.

    What a radar sees of ground that is barred from beside it is no search of it.

    Raises
    ------
    InfeasibleError
        ``"blocked"``; ``"hard-zone"`` where zones lie between.
    """
    if asked.room.reached.end_off:
        raise InfeasibleError(
            "hard-zone",
            end,
            f"no flight leads there from {start}: {_listed(asked.room.reached.walls)} in between",
            f"Move {end}, or leave a way open.",
            asked.pricing.end,
        )
    barred = asked.room.barred.area >= ALL * asked.ground.area
    if not barred and next(asked.flyable(), None) is not None:
        return
    place = asked.ground.representative_point()
    where = (float(place.x), float(place.y))
    walls = asked.room.reached.walls
    if walls and not barred:
        raise InfeasibleError(
            "hard-zone",
            asked.looking.names[0],
            f"no flight leads there from {start}: {_listed(walls)} in between, and no way leads round",
            f"Move {start} to the other side, or leave a way open.",
            where,
        )
    listed = _listed(asked.room.blocking(asked.ground))
    turns = f"turns of {asked.room.radius_m:.0f} m leave no pass over it from {asked.looking.height_m:.0f} m"
    raise InfeasibleError(
        "blocked",
        asked.looking.names[0],
        f"all of it lies in {listed}, where nothing may fly"
        if barred
        else f"nothing of it can be seen: {listed or 'its shape'} and {turns}",
        "Widen the area, move what blocks it, or fly at another altitude or with tighter turns.",
        where,
    )


def refuse_worthless(asked: Search, start: str) -> None:
    """Refuse a search that finds nothing whatever it takes: what is looked for lies where none leads to.

    Raises
    ------
    InfeasibleError
        ``"blocked"``, or ``"hard-zone"`` where zones lie between.
    """
    if asked.finds(asked.nearest()[0].worth):
        return
    walls = asked.room.reached.walls
    listed = _listed(walls or asked.room.blocking(asked.ground))
    place = asked.ground.representative_point()
    raise InfeasibleError(
        "hard-zone" if walls else "blocked",
        asked.looking.names[0],
        f"no flight from {start} finds anything of what is looked for: {listed or 'its shape'} in between",
        f"Move what is in the way, {start}, or what is important.",
        (float(place.x), float(place.y)),
    )


def cut_off(asked: Search, start: str) -> tuple[str, ...]:
    """What is said of ground that no flight leads to from a start, where there is some."""
    where = asked.room.reached
    share = where.cut_off.area / asked.ground.area
    if share < LEAST_TOLD:
        return ()
    return (
        f"{asked.looking.names[0]}: no flight leads to {share:.1%} of the ground from {start}: "
        f"{_listed(where.walls)} in between",
    )


def _listed(names: Sequence[str]) -> str:
    """Names, the first of them."""
    return ", ".join(names[:NAMED]) + f" and {len(names) - NAMED} more" * (len(names) > NAMED)
