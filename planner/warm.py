"""Compile every kernel once, so that the first plan is as fast as the second."""

from __future__ import annotations

import functools
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from numba.core.dispatcher import Dispatcher

from planner.compiling import Compiling
from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from planner.warm_cases import CASES, SCENARIO, usual


def load() -> None:
    """Load the kernels of a usual plan; where they had to be compiled for that, compile the others too.

    A process that is to plan at once is ready sooner than by :func:`warm_up`. Of several that begin at
    once where nothing is kept, one compiles.
    """
    Compiling().once(_load)


def prepare() -> None:
    """End an installation: compile every kernel, so that processes that begin later wait for nobody.

    Raises
    ------
    subprocess.CalledProcessError
        A share of it, compiled in a process beside this one, failed; its own words are on standard error.
    """
    Compiling().once(_all)


def share(claims: str) -> None:
    """Compile cases of :data:`planner.warm_cases.CASES` that no other process has claimed.

    Parameters
    ----------
    claims
        A folder; who makes the file of a case's name there has it.
    """
    for case in CASES:
        if _claimed(Path(claims) / case.__name__):
            case()


def _claimed(claim: Path) -> bool:
    try:
        claim.touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


def _all() -> bool:
    usual()
    if not compiled() or len(os.sched_getaffinity(0)) == 1:
        warm_up()
        return compiled() > 0
    with tempfile.TemporaryDirectory(prefix="swathplan-compiling-") as claims:
        program = f"from planner.warm import share; share({claims!r})"
        other = subprocess.Popen([sys.executable, "-c", program])
        try:
            share(claims)
        finally:
            code = other.wait()
    if code:
        raise subprocess.CalledProcessError(code, other.args)
    return True


def _load() -> bool:
    one = [feature for feature in SCENARIO["features"] if feature["id"] not in ("R1", "R2")]
    scenario = read_scenario(SCENARIO | {"features": one})
    with_bound(scenario, make_plan(scenario))
    if not compiled():
        return False
    warm_up()
    return True


def compiled() -> int:
    """How many kernels this process has compiled because none were kept from before."""
    kernels = {
        id(value): value
        for name, module in list(sys.modules.items())
        if name.startswith("planner.") and module is not None
        for value in vars(module).values()
        if isinstance(value, Dispatcher)
    }
    return sum(sum(kernel.stats.cache_misses.values()) for kernel in kernels.values())


@functools.cache
def warm_up() -> None:
    """Plan small scenarios by each method, once in a process."""
    usual()
    for case in CASES:
        case()
