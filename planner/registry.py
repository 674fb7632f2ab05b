"""Where the planner grows: one call makes a kind of sensor, or a task, known to every stage."""

from __future__ import annotations

from planner.check import footprints
from planner.coverage import registry as families
from planner.coverage.ways import Family
from planner.sensors import registry as sensors
from planner.tasks import registry as tasks
from planner.tasks.task import Task


def register_sensor(name: str, kind: sensors.Kind, family: Family, footprint: footprints.Footprint) -> None:
    """Have sensors of a ``type`` read, planned with and judged.

    Parameters
    ----------
    name
        Value of ``type``, and of ``Sensor.kind``.
    kind
        Reads them, and knows what they see on terrain.
    family
        Lays their passes.
    footprint
        What they see, for the judge: of its own making, not the family's.
    """
    sensors.register(name, kind)
    families.register(name, family)
    footprints.register(name, footprint)


def register_task(name: str, task: Task) -> None:
    """Have a value of ``task`` answered."""
    tasks.register(name, task)
