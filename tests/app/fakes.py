"""Stand-ins for the planner, importable from worker processes."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from app.services.errors import NotFoundError, RefusedError
from app.services.plans.summary import summary_of
from app.services.plans.work import PipeProgress, WorkResult, plan_scenario
from app.services.scenarios import validation
from app.services.scenarios.validation import Verdict
from planner.errors import Finding


def no_warm_up() -> None:
    """Compile nothing."""


class ThreadPool:
    """Runs plans in threads: ready at once, but what it runs can be neither stopped nor killed."""

    ready = True

    def warm(self) -> None:
        """Nothing to start."""

    async def mend(self) -> None:
        """Nothing to mend."""

    async def run(self, function: Callable[..., Any], args: tuple[Any, ...], timeout_s: float) -> Any:
        """Run a function to its end."""
        return await asyncio.to_thread(function, *args)

    async def stop(self) -> None:
        """Nothing to end."""


def endless() -> None:
    """Never ends, and lets no other thread of its process run for long."""
    while True:
        sum(range(10_000_000))


def greedy(size_bytes: int) -> int:
    """Take memory, and touch it."""
    return len(bytearray(size_bytes))


def dying() -> None:
    """End the process in the middle of its work."""
    os.kill(os.getpid(), signal.SIGKILL)


def refusing() -> None:
    """Refuse with a finding."""
    raise RefusedError("no", (Finding("R1", "a-rule", "it is wrong", "mend it"),))


def missing() -> None:
    """Miss something."""
    raise NotFoundError("terrain", "T")


def judge(document: Mapping[str, Any], *folders: str) -> Verdict:
    """Judge scenarios for real; of stand-ins refuse those without features, and warn of unnamed ones."""
    real = "vehicles" in document or "type" in document
    if real and "fake_plan" not in document and "fake" not in document:
        return validation.judge(document, *folders)
    errors = () if document.get("features") else (Finding("scenario", "no-features", "empty", "draw some"),)
    warnings = (
        () if document.get("name") else (Finding("scenario", "no-name", "unnamed", "name it", "warning"),)
    )
    return Verdict(errors, warnings)


def task(scenario_text: str, progress_path: str, *folders: str) -> WorkResult:
    """Do what the ``fake`` member says (``done`` where there is none); plan real scenarios for real."""
    scenario = json.loads(scenario_text)
    if "fake_plan" in scenario:
        plan = json.loads(Path(scenario["fake_plan"]).read_text())
        return WorkResult(plan=json.dumps(plan | scenario["members"]), summary=summary_of(plan))
    if "vehicles" in scenario:
        return plan_scenario(scenario_text, progress_path, *folders)
    progress = PipeProgress(progress_path)
    progress("coverage", 0.25)
    match scenario.get("fake", "done"):
        case "slow":
            for step in range(600):
                progress(f"step {step}", 0.25 + step / 1000)
                time.sleep(0.05)
        case "waits":
            while not Path(scenario["for"]).exists():
                time.sleep(0.02)
        case "die":
            dying()
        case "raise":
            raise RuntimeError("a secret of the inside")
        case "failed":
            return WorkResult(
                error={"type": "infeasible", "title": "No plan", "detail": "no way", "errors": []}
            )
    progress("routing", 0.75)
    plan = {"type": "FeatureCollection", "features": [], "metrics": {"length_m": 1.0}, "violations": []}
    return WorkResult(plan=json.dumps(plan), summary={"metrics": plan["metrics"], "violations": []})


def bound(scenario_text: str, plan_text: str, wanted_path: str, *folders: str) -> WorkResult | None:
    """Do what the ``fake_bound`` member says: a bound, ``raise``, or ``slow`` as long as one is wanted.

    A path to no file there is: the first time as long as one is wanted, and none then; a bound the next time.
    """
    wanted = json.loads(scenario_text).get("fake_bound")
    if wanted == "raise":
        raise RuntimeError("a secret of the inside")
    while wanted == "slow" and Path(wanted_path).exists():
        time.sleep(0.02)
    if wanted is None:
        return None
    if "/" in wanted and not Path(wanted).exists():
        Path(wanted).touch()
        while Path(wanted_path).exists():
            time.sleep(0.02)
        return None
    plan = json.loads(plan_text)
    plan["metrics"] |= {"lower_bound_m": 0.9, "gap": 0.1}
    return WorkResult(plan=json.dumps(plan), summary=summary_of(plan))
