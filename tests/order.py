"""In which order the suite runs, and what stays together, where several processes share it.

Half of the files wait most of their time: for services that start, aircraft that fly, pages that are drawn.
The other half computes. By their names those that wait came first, and the processors stood idle.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import PurePosixPath

import pytest
from xdist.scheduler import LoadFileScheduling

#: Folders whose tests mostly wait.
WAITING = ("tests/app", "tests/flows", "tests/mavlink/links", "tests/mavlink/sim", "tests/mavlink/station")
#: Folders whose files share what is costly to start, and run in one process.
TOGETHER = ("tests/app/browser",)
#: What takes longest, the longest first: the last to begin must not be the last to end, alone.
LONG = (
    "tests/app/browser",
    "tests/flows/test_examples.py",
    "tests/app/test_anywhere_flight.py",
    "tests/app/test_fuzz.py",
    "tests/planner/geojson/test_every_property.py",
    "tests/planner/bounds/test_ways.py",
    "tests/planner/coverage/test_relaxation.py",
)
#: Processes for each processor: one waits while the other computes.
WORKERS_EACH = 2
MOST_WORKERS = 8


def unit_of(nodeid: str) -> str:
    """The file of a test, or the folder whose files run in one process."""
    path = nodeid.split("::", 1)[0]
    return next((folder for folder in TOGETHER if path.startswith(folder + "/")), path)


def waits(unit: str) -> bool:
    """Whether a unit's tests mostly wait."""
    return any(PurePosixPath(unit).is_relative_to(folder) for folder in WAITING)


def in_order(units: Iterable[str]) -> list[str]:
    """Units in the order in which they begin: the long ones first, those that wait among those that compute.

    Both kinds come to their ends together, however many there are of each.
    """
    last = len(LONG)
    rank = {unit: place for place, unit in enumerate(LONG)}
    kinds: dict[bool, list[str]] = {True: [], False: []}
    for unit in sorted(dict.fromkeys(units), key=lambda unit: rank.get(unit, last)):
        kinds[waits(unit)].append(unit)
    placed = [((place + 0.5) / len(kind), unit) for kind in kinds.values() for place, unit in enumerate(kind)]
    return [unit for _, unit in sorted(placed, key=lambda each: each[0])]


def arrange(items: list[pytest.Item]) -> None:
    """Put tests in that order, in place; those of a unit keep theirs."""
    place = {unit: place for place, unit in enumerate(in_order(unit_of(item.nodeid) for item in items))}
    items.sort(key=lambda item: place[unit_of(item.nodeid)])


def workers() -> int:
    """How many processes share the suite where that is left to it."""
    return min(MOST_WORKERS, WORKERS_EACH * len(os.sched_getaffinity(0)))


class Scheduling(LoadFileScheduling):
    """Hands out whole units, in the order in which they were collected."""

    def _split_scope(self, nodeid: str) -> str:
        return unit_of(nodeid)
