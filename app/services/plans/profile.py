"""Heights along a plan's lines, of the aircraft and of the ground below it, and under its photos."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.services.plans.filed_mission import MEMBER
from app.services.terrain.rasters import stored_terrain
from planner.errors import ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.scenario import Scenario

Floats = NDArray[np.float64]

#: A line is told by so many places more than its corners, at most.
MOST_PLACES = 3000
MILLIMETRE = 3


def profile_of(plan_text: str, scenario_text: str, terrain_folder: Path | None) -> dict[str, Any]:
    """Heights along each path, and of the ground under each photo, over the datum of the plan's altitudes.

    Over a raster places are at half the distance of its posts; over flat ground they are the line's corners.
    A mission file's ground is not known, nor is that of a scenario whose raster is gone.
    """
    plan: dict[str, Any] = json.loads(plan_text)
    scenario = None if MEMBER in plan else _scenario(scenario_text, terrain_folder)
    features = [(feature["properties"], feature["geometry"]) for feature in plan["features"]]
    return {
        "altitude_reference": plan["altitude_reference"],
        "ground": None if scenario is None else "flat" if scenario.terrain is None else "raster",
        "paths": [
            _path(properties, geometry["coordinates"], scenario)
            for properties, geometry in features
            if properties["role"] == "path"
        ],
        "photos": [
            {
                "vehicle": properties["vehicle"],
                "seq": properties["seq"],
                "ground_m": _told(_ground_m(np.array(geometry["coordinates"])[:, :2], scenario)),
            }
            for properties, geometry in features
            if properties["role"] == "photos"
        ],
    }


def _scenario(text: str, terrain_folder: Path | None) -> Scenario | None:
    terrains = None if terrain_folder is None else partial(stored_terrain, terrain_folder)
    try:
        return read_scenario(json.loads(text), terrains)
    except ScenarioError:
        return None


def _path(
    properties: dict[str, Any], coordinates: list[list[float]], scenario: Scenario | None
) -> dict[str, Any]:
    places = np.array([[*place, 0.0][:3] for place in coordinates], dtype=np.float64)
    at_m, places = _along(places, float(properties["length_m"]), scenario)
    return {
        "vehicle": properties["vehicle"],
        "sortie": properties.get("sortie", 1),
        "at_m": _told(at_m),
        "altitude_m": _told(places[:, 2]),
        "ground_m": _told(_ground_m(places[:, :2], scenario)),
    }


def _along(places: Floats, length_m: float, scenario: Scenario | None) -> tuple[Floats, Floats]:
    """Places, shape (N, 3), and how far along the line they lie, by the plan's measure."""
    frame = LocalFrame(float(places[0, 0]), float(places[0, 1])) if scenario is None else scenario.frame
    flat_m = frame.to_local(places[:, :2])
    steps_m = np.hypot(np.hypot(*np.diff(flat_m, axis=0).T), np.diff(places[:, 2]))
    at_m = np.concatenate([[0.0], np.cumsum(steps_m)])
    total_m = float(at_m[-1])
    if total_m > 0.0 and length_m > 0.0:
        at_m *= length_m / total_m
    if scenario is None or scenario.terrain is None or total_m == 0.0:
        return at_m, places
    step_m = max(scenario.terrain.step_m / 2.0, length_m / MOST_PLACES)
    between_m = np.union1d(at_m, np.arange(0.0, float(at_m[-1]), step_m))
    columns = [np.interp(between_m, at_m, places[:, column]) for column in range(3)]
    return between_m, np.column_stack(columns)


def _ground_m(places: Floats, scenario: Scenario | None) -> Floats:
    """Of the ground over the plan's datum; NaN where it is not known."""
    if scenario is None:
        return np.full(len(places), np.nan)
    if scenario.terrain is not None:
        return scenario.terrain.at(scenario.frame.to_local(places))
    level = scenario.level
    return np.full(len(places), level.altitude_m - level.height_m)


def _told(values: Floats) -> list[float | None]:
    return [round(float(value), MILLIMETRE) if np.isfinite(value) else None for value in values]
