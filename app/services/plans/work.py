"""What runs inside a planning process: a scenario's text in, a plan's text or a reason out.

Only texts and plain values cross between processes, so no error class has to survive pickling.
"""

from __future__ import annotations

import contextlib
import errno
import json
import math
import os
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from app.priority import go_usual, stand_back

#: Reports closer together than this are dropped unless the stage changes.
REPORT_INTERVAL_S = 0.05
#: Its first figure is what RLIMIT_AS limits, in pages (proc(5)).
STATM = Path("/proc/self/statm")


@dataclass(frozen=True, slots=True)
class WorkResult:
    """A plan as GeoJSON text with its summary, or the reason there is none."""

    plan: str | None = None
    summary: dict[str, Any] | None = None
    error: dict[str, Any] | None = None


class PipeProgress:
    """Writes progress reports into a named pipe; never waits for the reader and outlives it.

    A pipe of its own for each plan, rather than one queue for all: a process killed while it holds the
    queue's lock would silence every other.
    """

    def __init__(self, path: str) -> None:
        self._fd: int | None = None
        with contextlib.suppress(OSError):
            self._fd = os.open(path, os.O_WRONLY | os.O_NONBLOCK)
        self._last_s = -1.0
        self._stage = ""

    def __call__(self, stage: str, fraction: float) -> None:
        """Take one report."""
        moment_s = time.monotonic()
        if self._fd is None or (stage == self._stage and moment_s - self._last_s < REPORT_INTERVAL_S):
            return
        self._last_s, self._stage = moment_s, stage
        line = json.dumps({"stage": stage[:64], "progress": min(max(fraction, 0.0), 1.0)}) + "\n"
        try:
            os.write(self._fd, line.encode())
        except OSError as error:
            if error.errno != errno.EAGAIN:
                self.close()

    def close(self) -> None:
        """Hang up."""
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None


def initialise() -> None:
    """Load the kernels before the first plan."""
    from planner.warm import load

    load()


def limited(initialiser: Callable[[], None], memory_bytes: int, behind: bool = True) -> None:
    """Begin a worker that may take so much memory more than it begins with (RLIMIT_AS).

    Parameters
    ----------
    behind
        Whether other processes go first; not where an order to a vehicle waits for it.
    """
    if behind:
        stand_back()
    else:
        go_usual()
    initialiser()
    if not STATM.exists():
        # Without Linux's figures nobody can tell what it begins with; the limit of time holds all the same.
        return
    taken_bytes = int(STATM.read_text().split()[0]) * resource.getpagesize()
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = taken_bytes + memory_bytes
    limit = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))


def ping() -> int:
    """Answer with the process id: the worker is up."""
    return os.getpid()


def finding_json(finding: Any) -> dict[str, str]:
    """A planner finding as an entry of a problem document's ``errors``."""
    return {
        "feature": finding.feature,
        "rule": finding.rule,
        "message": finding.message,
        "fix": finding.fix,
        "severity": finding.severity,
    }


def plan_scenario(scenario_text: str, progress_path: str, terrain_folder: str | None = None) -> WorkResult:
    """Plan one scenario, reporting into the pipe at ``progress_path``; rasters are in ``terrain_folder``."""
    from app.services.plans.fences import fence_notes
    from app.services.terrain.rasters import stored_terrain
    from planner import errors
    from planner.geojson import read_scenario, write_plan
    from planner.pipeline import make_plan

    progress = PipeProgress(progress_path)
    frame = None
    try:
        progress("reading", 0.0)
        terrains = None if terrain_folder is None else partial(stored_terrain, terrain_folder)
        scenario = read_scenario(json.loads(scenario_text), terrains)
        frame = scenario.frame
        plan = make_plan(scenario, progress=progress, clock=time.perf_counter)
        plan = replace(plan, warnings=(*plan.warnings, *fence_notes(plan)))
        return _written(write_plan(plan))
    except errors.ScenarioError as error:
        return WorkResult(
            error={
                "type": "scenario-refused",
                "title": "The scenario is refused",
                "detail": str(error),
                "errors": [finding_json(finding) for finding in error.findings],
            }
        )
    except errors.InfeasibleError as error:
        place = None
        if error.where_enu_m is not None and frame is not None:
            lon_deg, lat_deg = (float(value) for value in frame.to_wgs84(error.where_enu_m))
            place = [lon_deg, lat_deg]
        return WorkResult(
            error={
                "type": "infeasible",
                "title": "No plan can satisfy the scenario",
                "detail": error.message,
                "errors": [
                    {
                        "feature": error.feature,
                        "rule": error.constraint,
                        "message": error.message,
                        "fix": error.relaxation,
                        "where": place,
                    }
                ],
            }
        )
    except MemoryError:
        return WorkResult(
            error={
                "type": "memory-limit",
                "title": "The memory limit was reached",
                "detail": "planning takes more memory than a plan may have; send fewer or simpler regions",
                "errors": [],
            }
        )
    except errors.OutOfBudgetError as error:
        return WorkResult(
            error={
                "type": "out-of-budget",
                "title": "The budget ended before a plan was found",
                "detail": str(error),
                "errors": [],
            }
        )
    finally:
        progress.close()


def bound_plan(
    scenario_text: str, plan_text: str, wanted_path: str, terrain_folder: str | None = None
) -> WorkResult | None:
    """A plan made of a scenario once more, now with what no plan is shorter than.

    The search ends after its share of the work, the same on any machine, and where the scenario has a time
    budget with that. None where that leaves no time, and once there is no file any more at ``wanted_path``:
    what is found by then hangs on when that was.
    """
    began_s = time.perf_counter()
    from app.services.terrain.rasters import stored_terrain
    from planner import errors
    from planner.geojson import read_plan, read_scenario, write_plan
    from planner.pipeline import time_for_bound_s, with_bound

    terrains = None if terrain_folder is None else partial(stored_terrain, terrain_folder)
    plan = read_plan(json.loads(plan_text))
    scenario = read_scenario(json.loads(scenario_text), terrains)
    limit_s = time_for_bound_s(math.fsum(plan.metrics.planning_time_s.values()), scenario.time_budget_s)

    def enough() -> bool:
        return time.perf_counter() - began_s > limit_s

    def unwanted() -> bool:
        return not Path(wanted_path).exists()

    if enough():
        return None
    try:
        bounded = with_bound(scenario, plan, unwanted, enough, time.perf_counter, share=True)
    except errors.CancelledError:
        return None
    return _written(write_plan(bounded))


def _written(document: dict[str, Any]) -> WorkResult:
    from app.services.plans.summary import summary_of

    text = json.dumps(document, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return WorkResult(plan=text, summary=summary_of(document))
