"""Families of ways to see a region, by the kind of sensor they are for."""

from __future__ import annotations

from planner.coverage.strips.family import Strips
from planner.coverage.survey.family import Surveys
from planner.coverage.ways import Family
from planner.sensors.base import Sensor

FAMILIES: dict[str, Family] = {"sar": Strips(), "camera": Surveys()}


def register(kind: str, family: Family) -> None:
    """Have regions seen with sensors of a kind by a family."""
    FAMILIES[kind] = family


def family_of(sensor: Sensor) -> Family:
    """The family for a sensor."""
    return FAMILIES[sensor.kind]
