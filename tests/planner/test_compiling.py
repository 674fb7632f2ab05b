"""Who compiles where several processes begin at once."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from planner.compiling import Compiling
from tests.patience import PATIENCE_S

ROOT = Path(__file__).resolve().parents[2]
#: Loads at once what a file says is kept; else takes its time to make that file, and says so.
PROGRAM = """
import sys, time
from pathlib import Path
from planner.compiling import Compiling
folder, seconds, patience_s = Path(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
kept = folder / "kept"
def load():
    if kept.exists():
        return False
    print("compiles", flush=True)
    time.sleep(seconds)
    kept.touch()
    return True
Compiling(folder, patience_s).once(load)
print("ready", flush=True)
"""


def begun(folder: Path, seconds: float = 0.0, patience_s: float = 60.0) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", PROGRAM, str(folder), str(seconds), str(patience_s)]
    return subprocess.Popen(
        command, cwd=ROOT, env=os.environ | {"PYTHONPATH": str(ROOT)}, stdout=subprocess.PIPE, text=True
    )


def test_of_several_that_begin_at_once_one_compiles(tmp_path: Path) -> None:
    """The others wait for it, and take what it has made."""
    processes = [begun(tmp_path, 1.0) for _ in range(4)]
    said = [process.communicate(timeout=PATIENCE_S)[0].split() for process in processes]
    assert sorted(said) == [["compiles", "ready"], ["ready"], ["ready"], ["ready"]]
    assert Compiling(tmp_path).done


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_one_that_ends_or_hangs_keeps_nobody(tmp_path: Path, how: signal.Signals) -> None:
    """A killed one is followed at once, one that stands still when patience is over."""
    first = begun(tmp_path, 600.0)
    try:
        assert first.stdout is not None
        assert first.stdout.readline() == "compiles\n"
        first.send_signal(how)
        second = begun(tmp_path, 0.0, 60.0 if how == signal.SIGKILL else 0.5)
        assert second.communicate(timeout=PATIENCE_S)[0].split() == ["compiles", "ready"]
    finally:
        first.kill()
        first.communicate()


def test_what_is_kept_no_more_is_compiled_anew_in_turn(tmp_path: Path) -> None:
    """A folder that says that all was compiled, and lacks it: in turn, too, and once."""
    Compiling(tmp_path).once(lambda: True)
    processes = [begun(tmp_path, 0.0) for _ in range(2)]
    said = [process.communicate(timeout=PATIENCE_S)[0].split() for process in processes]
    assert all(words[-1] == "ready" for words in said)
    assert (tmp_path / "kept").exists()


def test_without_a_folder_to_write_each_loads_for_itself(tmp_path: Path) -> None:
    """Nothing can be kept and nobody is waited for."""
    (tmp_path / "file").touch()
    loads = 0

    def load() -> bool:
        nonlocal loads
        loads += 1
        return True

    began_s = time.monotonic()
    Compiling(tmp_path / "file" / "below").once(load)
    assert loads == 1
    assert time.monotonic() - began_s < 5.0
