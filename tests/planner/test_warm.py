"""What a process does before its first plan."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from planner.compiling import Compiling

ROOT = Path(__file__).resolve().parents[2]
#: What a service does in the life of a planning process, told in numbers.
PROGRAM = """
import json, sys
from planner import warm
from planner.geojson import read_scenario
from planner.pipeline import make_plan
loaded = []
everything = warm.warm_up
warm.warm_up = lambda: loaded.append("everything")
warm.load()
before = warm.compiled()
for name in [*(f"sar-case-{case}" for case in range(1, 5)), "three-aircraft"]:
    make_plan(read_scenario(json.load(open(f"examples/{name}.geojson"))))
print(json.dumps([before, warm.compiled(), loaded]))
"""


def test_loading_after_a_compilation_compiles_nothing() -> None:
    """With kernels kept from before, neither loading nor the shared cases nor a fleet compile a kernel."""
    compiling = [sys.executable, "-c", "from planner.warm import prepare; prepare()"]
    subprocess.run(compiling, cwd=ROOT, check=True)
    assert Compiling().done
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], cwd=ROOT, check=True, capture_output=True, env=os.environ, text=True
    )
    assert json.loads(done.stdout) == [0, 0, []]


def test_a_kernel_without_a_kept_form_counts(tmp_path: Path) -> None:
    """In an empty folder of kernels a single call is counted as compiled."""
    program = (
        "from planner import warm\nfrom planner.dubins.kernels import dubins_length\n"
        "dubins_length(0.0, 0.0, 0.0, 500.0, 0.0, 0.0, 100.0)\nprint(warm.compiled())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        check=True,
        capture_output=True,
        env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)},
        text=True,
    )
    assert int(done.stdout) >= 1
