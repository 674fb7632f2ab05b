"""Tasks by the name that scenarios use."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from planner.tasks.task import Task


def _collect() -> Task:
    # Reading a scenario asks for the names alone: no solver is loaded for that.
    from planner.tasks.collect import COLLECT

    return COLLECT


def _search() -> Task:
    from planner.tasks.search import SEARCH

    return SEARCH


#: What finds each task.
TASKS: dict[str, Callable[[], Task]] = {"collect": _collect, "search": _search}


def register(name: str, task: Task) -> None:
    """Have scenarios ask for a task by a name."""
    TASKS[name] = lambda: task


def task_of(name: str) -> Task:
    """The task of a name."""
    return TASKS[name]()
