"""Kernels that several processes compile and keep in one folder are each their own when they are loaded."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from itertools import permutations
from pathlib import Path

import pytest
from numba.core.bytecode import FunctionIdentity
from numba.core.caching import IndexDataCacheFile

import planner.jit
from tests.patience import PATIENCE_S

ROOT = Path(__file__).resolve().parents[2]
#: Both sort, one by a copy and one by places; by numba's count the helpers of both have one number.
KERNELS = {
    "by_place": """
import numpy as np
from planner.jit import njit

@njit(cache=True)
def one(x):
    return x

@njit(cache=True)
def two(x):
    return x

@njit(cache=True)
def ascending(x):
    return x[np.argsort(two(one(x)))]
""",
    "by_copy": """
from planner.jit import njit

@njit(cache=True)
def ascending(x):
    y = x.copy()
    y.sort()
    return y
""",
}
#: Runs kernels named by their modules, in that order, and says how many were kept from before.
PROGRAM = """
import importlib, sys
import numpy as np
values, kept = np.random.default_rng(7).random(500), 0
for name in sys.argv[1:]:
    kernel = importlib.import_module(name).ascending
    assert np.all(np.diff(kernel(values)) >= 0.0), name
    kept += sum(kernel.stats.cache_hits.values())
print(kept)
"""


def run(folder: Path, *names: str) -> str:
    """What a process says that runs kernels which lie in a folder."""
    return run_program(folder, PROGRAM, *names)


def run_program(folder: Path, program: str, *names: str) -> str:
    """What a program says that finds modules in a folder."""
    told = os.environ | {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}", "NUMBA_CACHE_DIR": str(folder / "kept")}
    # A source changed within the second would be taken for the one that Python has compiled.
    told["PYTHONDONTWRITEBYTECODE"] = "1"
    command = [sys.executable, "-c", program, *names]
    ended = subprocess.run(command, env=told, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.strip()


def test_what_two_processes_compiled_is_not_mixed_up_by_a_third(tmp_path: Path) -> None:
    """Helpers of one name, compiled apart for two kernels, are run each by its own."""
    for name, text in KERNELS.items():
        (tmp_path / f"{name}.py").write_text(text)
        assert run(tmp_path, name) == "0"
    for order in permutations(KERNELS):
        assert run(tmp_path, *order) == "2"


CALLER = """
from planner.jit import njit
from lower import ADDED, step

@njit(cache=True)
def ascending(x):
    return later(x) + ADDED

@njit(cache=True)
def later(x):
    return step(x)
"""
LOWER = """
from planner.jit import njit
from lowest import FACTOR
ADDED = {added}

@njit(cache=True)
def step(x):
    return x * FACTOR
"""
CALLING = """
import caller
print(caller.ascending(1.0), sum(caller.ascending.stats.cache_hits.values()))
"""


def test_a_kernel_is_compiled_anew_when_what_it_takes_from_elsewhere_has_changed(tmp_path: Path) -> None:
    """Constants and kernels of other files, through kernels between, defined before or after it."""

    def told(added: float, factor: float) -> list[str]:
        texts = {"caller": CALLER, "lower": LOWER.format(added=added), "lowest": f"FACTOR = {factor}\n"}
        for name, text in texts.items():
            file = tmp_path / f"{name}.py"
            if not file.exists() or file.read_text() != text:
                file.write_text(text)
        return run_program(tmp_path, CALLING).split()

    assert told(0.5, 2.0) == ["2.5", "0"]
    assert told(0.5, 2.0) == ["2.5", "1"]
    assert told(0.25, 2.0) == ["2.25", "0"]
    assert told(0.25, 3.0) == ["3.25", "0"]
    assert told(0.25, 3.0) == ["3.25", "1"]


def test_forks_draw_other_names(tmp_path: Path) -> None:
    """Two forks of one process, which share all it has counted so far, compile under different names."""
    drawn: list[str] = []
    for number in range(2):
        place = tmp_path / str(number)
        child = os.fork()
        if child == 0:
            place.write_text(str(next(FunctionIdentity._unique_ids)))
            os._exit(0)
        assert os.waitpid(child, 0)[1] == 0
        drawn.append(place.read_text())
    assert drawn[0] != drawn[1]


def test_forms_kept_at_the_same_moment_are_all_kept(tmp_path: Path) -> None:
    """Each signature loads its own form, whoever saved another one of the kernel meanwhile."""
    count = 8
    together = threading.Barrier(count)

    def keep(number: int) -> None:
        together.wait()
        IndexDataCacheFile(str(tmp_path), "kernel", "stamp").save(number, f"form {number}")

    with ThreadPoolExecutor(count) as keepers:
        list(keepers.map(keep, range(count)))
    kept = IndexDataCacheFile(str(tmp_path), "kernel", "stamp")
    assert [kept.load(number) for number in range(count)] == [f"form {number}" for number in range(count)]


@pytest.mark.parametrize("folder", ["planner", "app", "mavlink", "benchmarks", "tests"])
def test_every_kernel_is_made_so(folder: str) -> None:
    """Nothing takes numba's own decorators past it."""
    allowed = {ROOT / "planner" / name for name in ("compiling.py", "warm.py")}
    allowed |= {Path(planner.jit.__file__), Path(__file__)}
    taken = re.compile(r"^(from numba\b|import numba\b)", re.MULTILINE)
    sources = set((ROOT / folder).rglob("*.py")) - allowed
    assert not [source for source in sources if taken.search(source.read_text())]
