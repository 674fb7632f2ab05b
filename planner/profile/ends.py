"""Both ends of a flight as its aircraft and autopilot fly them: up from the start, down to the end."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from planner.airspace.terrain import Ground
from planner.airspace.zones import KeepOut
from planner.dubins.path import Path, join
from planner.dubins.run_kernels import NO_DISCS, run_costs
from planner.plan import Finish
from planner.profile.circling import circle_down
from planner.profile.foot import HEADINGS, Foot
from planner.profile.heights import Heights, level
from planner.profile.lines import stored_radius_m
from planner.profile.rise import Connect, Rise, Terms, fall, rise, turned
from planner.progress import Stop, never
from planner.route import Anchor, Terminal
from planner.vehicle import manners
from planner.vehicle.manners import manners_of
from planner.vehicle.model import FlightModel
from planner.vehicle.wind import CIRCLE_RAD, ground_speed_m_s

#: Flown level before a first pass, while the autopilot settles on its height.
LEVEL_OFF_S = 5.0
#: Kept to spare of climbing and descending turns: ArduPlane came to one 20 m high, and flew another.
SPARE_S = 6.0
#: Winds slower than this do not choose the direction of a take-off or a landing, nor what of one is from
#: behind where no other way leads.
MINDED_WIND_M_S = 2.0
#: Circles are so much wider than the tightest turn.
EASY_TURN = 1.05


@dataclass(frozen=True, slots=True)
class Surround:
    """What both ends of a flight are placed in.

    Parameters
    ----------
    top_m
        Altitude of the route over the flight's datum.
    zones
        What is to be kept out of at any height from the ground up to the top, margins included.
    connect, cost_m
        See ``Terms``.
    ground
        Terrain and what is kept over it, in altitudes over the same datum; None where the ground is flat.
    clearance_m
        Kept over terrain behind take-off and before landing.
    raised
        Heights as they are flown along a line, where those of a level route are not.
    """

    top_m: float
    zones: KeepOut
    connect: Connect
    cost_m: Callable[[Path], float]
    ground: Ground | None = None
    clearance_m: float = 0.0
    stop: Stop = never
    raised: Callable[[Path, Heights], Heights] = lambda path, heights: heights


def up(start: Terminal, ground_m: float, goal: Anchor, model: FlightModel, around: Surround) -> Rise:
    """From lift-off to a goal at the route's height.

    Raises
    ------
    InfeasibleError
        Where no line leads there.
    """
    foot = _likely(foot_up(start, ground_m, around.top_m, model), goal, model)
    return rise(foot, goal, terms_of(around, model, climbs=True))


def with_run(ends: tuple[Terminal, Terminal], top_m: float, model: FlightModel) -> tuple[Terminal, Terminal]:
    """Both ends, the start with the run that a flight to a height over it begins with; none in the air."""
    start, end = ends
    if start.over_home_m is not None:
        return ends
    foot = foot_up(start, 0.0, top_m, model)
    return replace(start, run_m=foot.run_m, runs_rad=_runs_rad(foot)), end


def _runs_rad(foot: Foot) -> tuple[float, ...]:
    """Directions of a foot's run, ascending."""
    ways = [angle for natural in (0.0, math.pi / HEADINGS) for angle in foot.headings(natural)]
    return tuple(sorted({math.remainder(angle, math.tau) for angle in ways if angle is not None}))


def _likely(foot: Foot, goal: Anchor, model: FlightModel) -> Foot:
    """A foot that knows the direction behind which the line to a goal is shortest without zones."""
    if foot.run_m <= 0.0 or goal.angle_rad is None:
        return foot
    pose = np.array([[goal.east_m, goal.north_m, goal.angle_rad]])
    runs_rad = np.array(_runs_rad(foot))
    _, best_rad = run_costs(*foot.position, foot.run_m, runs_rad, pose, model.turn_radius_m, NO_DISCS)
    return replace(foot, likely_rad=float(best_rad[0]))


def foot_up(start: Terminal, ground_m: float, top_m: float, model: FlightModel) -> Foot:
    """How a flight to an altitude leaves the ground."""
    slope_rad = climb_slope_rad(model)
    aircraft, height_m = model.aircraft, top_m - ground_m
    lift_m = run_m = rise_m = 0.0
    if aircraft.type == "multirotor":
        lift_m = height_m
    elif aircraft.type == "vtol":
        lift_m = min(manners.TAKE_OFF_HEIGHT_M, height_m)
        run_m = manners.VTOL_SPEED_UP_S * model.airspeed_m_s
    else:
        rise_m = min(manners.TAKE_OFF_HEIGHT_M, height_m)
        run_m = rise_m / math.tan(slope_rad)
    return _foot(start.position, start.angle_rad, ground_m, (lift_m, run_m, rise_m), model)


def down(
    end: Terminal,
    home: tuple[float, float],
    grounds_m: tuple[float, float],
    origin: Anchor,
    model: FlightModel,
    around: Surround,
    finish: Finish,
) -> Rise:
    """From an origin at the route's height to the ground at the end, or to the circle that a flight ends in.

    Parameters
    ----------
    grounds_m
        Altitude of the ground at home and at the end.

    Returns
    -------
    Rise
        Its ``run_m`` and ``turns_m`` count from the end, backwards.
    """
    slope_rad = sink_slope_rad(model)
    terms = terms_of(around, model, climbs=False)
    aircraft = model.aircraft
    if aircraft.type != "multirotor" and finish != "land":
        # The route ends over its end; the circle follows.
        leg = around.connect(origin, Anchor(*end.position, end.angle_rad))
        centre = home if finish == "return" else end.position
        bottom_m = min(around.top_m, grounds_m[0] + manners.RETURN_HEIGHT_M)
        over = Anchor(*leg.end.position, leg.end.angle_rad)
        circled = circle_down(over, centre, bottom_m if finish == "return" else around.top_m, terms)
        heights = level(leg.length_m, around.top_m).then(circled.heights)
        return Rise(join(leg, circled.path), heights, 0.0, circled.turns_m, circled.inserted_m)
    place, ground_m = (home, grounds_m[0]) if finish == "return" else (end.position, grounds_m[1])
    height_m = around.top_m - ground_m
    lift_m = run_m = rise_m = 0.0
    if aircraft.type == "multirotor":
        lift_m = 0.0 if finish == "loiter" else height_m
        ground_m = around.top_m - lift_m
    elif aircraft.type == "vtol":
        lift_m = min(manners.APPROACH_HEIGHT_M, height_m)
        stop_m = model.airspeed_m_s**2 / (2.0 * manners.VTOL_BRAKING_M_S2)
        run_m = max(manners.VTOL_STOPS * stop_m, lift_m)
    else:
        rise_m = min(manners.APPROACH_HEIGHT_M, height_m)
        run_m = rise_m / math.tan(min(math.radians(manners.APPROACH_SLOPE_DEG), slope_rad))
    angle_rad = end.angle_rad if finish == "land" else None
    foot = _foot(place, angle_rad, ground_m, (lift_m, run_m, rise_m), model)
    return fall(_likely(foot, turned(origin), model), origin, terms)


def climb_slope_rad(model: FlightModel) -> float:
    """Steepest climb over the ground: the aircraft's, and with the wind behind no faster than it is flown."""
    return _slope_rad(model, manners_of(model.aircraft).climb_m_s)


def sink_slope_rad(model: FlightModel) -> float:
    """Steepest descent over the ground."""
    return _slope_rad(model, manners_of(model.aircraft).sink_m_s)


def _slope_rad(model: FlightModel, rate_m_s: float) -> float:
    fastest_m_s = model.airspeed_m_s + model.wind.speed_m_s
    return min(math.radians(model.max_climb_deg), math.atan(rate_m_s / fastest_m_s))


def _turning_rad(model: FlightModel, *, climbs: bool) -> float:
    """Steepest in whole turns, on the mean: they are flown at one rate, the wind behind in a part of each."""
    manner = manners_of(model.aircraft)
    rate_m_s = manner.climb_m_s if climbs else manner.sink_m_s
    speeds_m_s = ground_speed_m_s(CIRCLE_RAD, model.airspeed_m_s, model.wind)
    mean_m_s = 1.0 / float((1.0 / speeds_m_s).mean())
    return min(math.radians(model.max_climb_deg), math.atan(rate_m_s / mean_m_s))


def circle_radius_m(model: FlightModel) -> float:
    """Radius of climbing and descending turns: somewhat above the tightest turn, as missions can say it."""
    return stored_radius_m(EASY_TURN * model.turn_radius_m)


def _foot(
    place: tuple[float, float],
    angle_rad: float | None,
    ground_m: float,
    lift_run_rise_m: tuple[float, float, float],
    model: FlightModel,
) -> Foot:
    """A foot into the wind, or across it, where that is minded."""
    speed_m_s = model.wind.speed_m_s
    if speed_m_s < MINDED_WIND_M_S or model.aircraft.type == "multirotor":
        return Foot(place, angle_rad, ground_m, *lift_run_rise_m)
    into_rad = model.wind.toward_rad + math.pi
    slow = MINDED_WIND_M_S / speed_m_s
    return Foot(place, angle_rad, ground_m, *lift_run_rise_m, into_rad, slow_behind=slow)


def terms_of(around: Surround, model: FlightModel, *, climbs: bool) -> Terms:
    """What a climb, or a descent, of an aircraft keeps to."""
    slope_rad = climb_slope_rad(model) if climbs else sink_slope_rad(model)

    def too_low(path: Path, heights: Heights) -> bool:
        ground = around.ground
        if ground is None:
            return False
        heights = around.raised(path, heights)
        points = path.sample(ground.step_m / 2.0, ground.step_m / 2.0)
        clear_m = heights.at(points[:, 3]) - ground.at(points[:, :2])
        # At the run's end the aircraft is lower than what is kept; it may be, for as long as it climbs out.
        kept_m = np.minimum(around.clearance_m, heights.knots[0][1] - ground.at(points[:1, :2]))
        wanted_m = np.minimum(around.clearance_m, kept_m + points[:, 3] * math.tan(slope_rad))
        return bool(np.any(~(clear_m >= wanted_m - 1e-6)))

    return Terms(
        around.top_m,
        slope_rad,
        _turning_rad(model, climbs=climbs),
        circle_radius_m(model),
        LEVEL_OFF_S * model.airspeed_m_s,
        around.zones,
        around.connect,
        around.cost_m,
        SPARE_S * model.airspeed_m_s,
        too_low,
        around.stop,
    )
