"""The first plan of a service that has just been started, beside a later one.

Kernels are compiled into a folder of their own by the command that ``make run`` ends its installation with;
then a fresh service is started on it, and as soon as it answers a scenario is posted to it, and posted again.
Run as ``python -m benchmarks.start``; prints JSON lines.

On a machine that is busy otherwise (``machine_load``: how many processes want to run) the clock tells of the
others too; the processor time does not.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
#: The line of the Makefile's installation.
COMPILE = "from planner.warm import prepare; prepare()"
#: A first plan may take this much longer than a later one.
ALLOWED_S = 3.0
WAIT_S = 240
WARM_PLANS = 3


def _environment(kernels: Path) -> dict[str, str]:
    return os.environ | {"NUMBA_CACHE_DIR": str(kernels), "SWATHPLAN_LOG_LEVEL": "error"}


def _compiled(kernels: Path) -> int:
    return sum(1 for _ in kernels.rglob("*.nbc"))


def _cpu_s(pid: int) -> float:
    """Processor time of a process and its children so far, from /proc/<pid>/stat."""
    # Behind the name in brackets, utime and stime are the fields 12 and 13, counted from 1.
    after_name = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    own_s = (int(after_name[11]) + int(after_name[12])) / os.sysconf("SC_CLK_TCK")
    children = [
        int(child)
        for thread in Path(f"/proc/{pid}/task").iterdir()
        for child in (thread / "children").read_text().split()
    ]
    return own_s + sum(_cpu_s(child) for child in children)


def _plan_s(address: str, scenario: bytes, pid: int) -> tuple[float, float]:
    """Seconds from the request to the plan: by the clock, and of processor time."""
    begun_s, begun_cpu_s = time.perf_counter(), _cpu_s(pid)
    request = urllib.request.Request(f"{address}/api/v1/plans?wait={WAIT_S}", scenario)
    with urllib.request.urlopen(request, timeout=WAIT_S + 10) as answer:
        record = json.load(answer)
    if record["state"] != "done":
        raise RuntimeError(f"the plan is {record['state']}: {record['error']}")
    return time.perf_counter() - begun_s, _cpu_s(pid) - begun_cpu_s


def first_and_later(scenario: bytes, kernels: Path, folder: Path) -> dict[str, float]:
    """Start a service, plan at once, plan again; ``later_s`` is the quickest of some."""
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--json"]
    command += ["--database", str(folder / "plans.db")]
    begun_s = time.perf_counter()
    with subprocess.Popen(
        command, cwd=ROOT, env=_environment(kernels), stdout=subprocess.PIPE, text=True
    ) as service:
        try:
            assert service.stdout is not None
            address = json.loads(service.stdout.readline())["address"]
            listening_s = time.perf_counter() - begun_s
            first_s, first_cpu_s = _plan_s(address, scenario, service.pid)
            later = [_plan_s(address, scenario, service.pid) for _ in range(WARM_PLANS)]
        finally:
            service.terminate()
    later_s, later_cpu_s = (min(column) for column in zip(*later, strict=True))
    return {
        "listening_s": listening_s,
        "first_s": first_s,
        "later_s": later_s,
        "first_cpu_s": first_cpu_s,
        "later_cpu_s": later_cpu_s,
    }


def run(cases: tuple[int, ...] = (1, 2, 3, 4), empty: bool = False) -> Iterator[dict[str, Any]]:
    """One row a case.

    Parameters
    ----------
    cases
        Which of ``examples/sar-case-*.geojson``.
    empty
        Also start once without any kernel compiled before.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if empty:
            yield _row(cases[0], folder / "nothing", folder / "0", None)
        kernels = folder / "kernels"
        begun_s = time.perf_counter()
        subprocess.run([sys.executable, "-c", COMPILE], cwd=ROOT, env=_environment(kernels), check=True)
        compiling_s = time.perf_counter() - begun_s
        for case in cases:
            yield _row(case, kernels, folder / str(case), compiling_s)


def _row(case: int, kernels: Path, folder: Path, compiling_s: float | None) -> dict[str, Any]:
    folder.mkdir()
    kernels.mkdir(exist_ok=True)
    before = _compiled(kernels)
    times_s = first_and_later((EXAMPLES / f"sar-case-{case}.geojson").read_bytes(), kernels, folder)
    more_s = times_s["first_s"] - times_s["later_s"]
    more_cpu_s = times_s["first_cpu_s"] - times_s["later_cpu_s"]
    return {
        "benchmark": "start",
        "case": case,
        "kernels": "none" if compiling_s is None else "compiled at installation",
        "compiling_s": compiling_s,
        **times_s,
        "more_s": more_s,
        "more_cpu_s": more_cpu_s,
        "allowed_s": ALLOWED_S,
        "within": more_s <= ALLOWED_S,
        "machine_load": os.getloadavg()[0],
        "cores": os.cpu_count(),
        "compiled_later": _compiled(kernels) - before,
    }


if __name__ == "__main__":
    for row in run():
        sys.stdout.write(json.dumps(row) + "\n")
        sys.stdout.flush()
