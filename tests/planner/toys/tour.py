"""A task that flies over the middle of every region, sensors off."""

from __future__ import annotations

import math

from planner.route import Anchor
from planner.routing.tour import order
from planner.scenario import Scenario
from planner.tasks.flying import Station
from planner.tasks.methods import chosen_methods
from planner.tasks.setting import Setting
from planner.tasks.task import Answer, Controls, Task
from planner.tasks.transits import Transits


def fly(scenario: Scenario, controls: Controls) -> Answer:
    """From middle to middle, in the shortest order."""
    setting, methods = Setting.of(scenario), chosen_methods(scenario.method)
    start, end = setting.ends
    middles = [region.area.centroid.coords[0] for region in scenario.regions]
    with controls.stage("routing"):
        visiting = order(middles, start.position, end.position, "exact")
    stations = [Station(scenario.regions[k].name, Anchor(*middles[k])) for k in visiting]
    with controls.stage("transit"):
        transits = Transits.of(setting, scenario.objective, methods)
        composed, legs, notes = transits.by(stations, controls.progress, controls.stop)
    return Answer(setting, composed, legs, (), methods, (), notes)


def straight_m(scenario: Scenario, *_: object) -> float:
    """No line is shorter than the straight one."""
    return math.dist(scenario.start.position, scenario.end.position)


TOUR = Task(fly, straight_m)
