"""Stages called with a whole scenario, as the tasks unpack it."""

from __future__ import annotations

from functools import partial
from typing import Any

from shapely.geometry.base import BaseGeometry

from planner.airspace import prices
from planner.airspace.surroundings import Surroundings
from planner.bounds import lower, ways
from planner.coverage.strips import zigzag as of_zigzag
from planner.coverage.strips.located import located
from planner.coverage.strips.room import Room
from planner.coverage.visible import Seeing
from planner.progress import Progress, Stop, never, silent
from planner.route import CollectPass, Route
from planner.routing.greedy.route import li2018_route as paper_route
from planner.routing.joint.route import JointRoute, Search
from planner.routing.joint.route import joint_route as of_targets
from planner.routing.legs import Legs
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.tasks import hidden
from planner.tasks.collect import part_of
from planner.tasks.setting import Setting
from planner.tasks.setting import seeing as of_setting
from planner.vehicle.model import FlightModel

Sides = tuple[Any, ...]


def seeing(scenario: Scenario) -> Seeing:
    """What is to be seen, by the first aircraft in the scenario's wind."""
    return of_setting(scenario, Setting.of(scenario))


def surroundings(scenario: Scenario) -> Surroundings:
    """What its first aircraft flies among."""
    return seeing(scenario).surroundings()


def sides_of(scenario: Scenario) -> tuple[Sides, ...]:
    """The ways to see each region, part of one or visit to one that is not left out."""
    targets: tuple[Any, ...] = seeing(scenario).visible(surroundings(scenario)).targets
    return tuple(target.sides for target in targets)


def ends_of(scenario: Scenario) -> tuple[Any, Any]:
    """Start and end."""
    return (scenario.start, scenario.end)


def sensing(scenario: Scenario, sensor: SarSensor, area: BaseGeometry) -> tuple[Any, float]:
    """A sensor of the scenario over an area."""
    return scenario.suite.over(sensor.name, area, scenario.airspace, scenario.level)


def soft_prices(scenario: Scenario) -> Any:
    """Discs of soft threats with their prices."""
    return prices.soft_prices(scenario.airspace, scenario.level, scenario.objective)


def legs_of(scenario: Scenario, stop: Stop = never) -> Legs:
    """True costs of transits in a scenario."""
    setting = Setting.of(scenario)
    where = (setting.airspace, setting.level, setting.model)
    return Legs(*where, scenario.objective, setting.ends, stop)


def joint_route(
    scenario: Scenario, progress: Progress = silent, stop: Stop = never, enough: Stop = never
) -> JointRoute:
    """The joint choice, with passes besides for what terrain hides."""
    asked, around = seeing(scenario), surroundings(scenario)

    def complete(passes: tuple[CollectPass, ...], legs: Legs) -> tuple[CollectPass, ...]:
        return see_hidden(scenario, around, passes, legs, stop)

    ends, legs = ends_of(scenario), legs_of(scenario, stop)
    search = Search(ends, around, legs, scenario.seed, complete, progress, stop, enough)
    share = partial(asked.sharing, around=around)
    return of_targets(search, asked.visible(around), lambda ways: asked.visible(around, ways), share)


def see_hidden(
    scenario: Scenario, around: Surroundings, passes: Any, legs: Legs, stop: Stop = never
) -> tuple[CollectPass, ...]:
    """A tour with passes besides; the same where the ground is flat."""
    sight = sight_of(scenario)
    if sight is None:
        return passes
    return hidden.see_hidden(sight, lambda level: around, ends_of(scenario), passes, legs, stop)


def sight_of(scenario: Scenario) -> hidden.Sight | None:
    """What passes see of its terrain; None on flat ground."""
    return hidden.Sight.of(scenario.regions, scenario.suite, scenario.airspace, scenario.level)


class Greedy:
    """The paper's route and how it came about."""

    def __init__(self, route: Route, regions: tuple[Any, ...], dropped: tuple[Any, ...]) -> None:
        self.route, self.regions, self.dropped = route, regions, dropped


def greedy(
    scenario: Scenario,
    progress: Progress = silent,
    stop: Stop = never,
    *,
    threat_aware: bool = False,
    tour: Any = "genetic",
    **options: Any,
) -> Greedy:
    """The paper's stages in turn."""
    asked = seeing(scenario)
    where = (asked.airspace, asked.level)
    room = Room.of(*where, asked.model, asked.objective, threat_aware=threat_aware)
    sights = part_of(progress, 0.0, 0.8)
    found = located(asked.regions, asked.suite, *where, lambda level: room, sights, stop, **options)
    threats = tuple(t for t in scenario.threats if scenario.height_m <= t.height_m)
    controls = (scenario.seed, part_of(progress, 0.8, 1.0), stop)
    route, order = paper_route(
        found.choices, threats, scenario.objective, ends_of(scenario), *controls, tour=tour
    )
    return Greedy(route, tuple(found.choices[k].region for k in order), found.dropped)


def li2018_route(scenario: Scenario, **options: Any) -> Route:
    """The paper's route alone."""
    return greedy(scenario, **options).route


def room_of(scenario: Scenario, *, threat_aware: bool) -> Room:
    """The ground the paper's route has to itself."""
    asked = seeing(scenario)
    where = (asked.airspace, asked.level, asked.model, asked.objective)
    return Room.of(*where, threat_aware=threat_aware)


def plan_bound_m(scenario: Scenario, length_m: float, *rest: Any, **named: Any) -> float:
    """No plan for the scenario is shorter."""
    return ways.plan_bound_m(seeing(scenario), ends_of(scenario), length_m, *rest, **named)


def lower_bound_m(scenario: Scenario, sides: Any, known_m: float, *rest: Any, **named: Any) -> float:
    """No plan that sees each of some regions in one of its ways is shorter."""
    model = FlightModel.of(scenario.aircraft[0], scenario.wind)
    return lower.lower_bound_m(ends_of(scenario), model, sides, known_m, *rest, **named)


def zigzag(scenario: Scenario, direction: Any) -> of_zigzag.Zigzag:
    """The zigzag baseline."""
    areas = [region.area for region in scenario.regions]
    sensor: Any = scenario.sensors[0]
    return of_zigzag.zigzag(areas, sensor, scenario.height_m, ends_of(scenario), direction)
