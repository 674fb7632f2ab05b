"""``docker/journey.sh`` as its reader runs it, against simulators that run here: service, curl, report.

Each is skipped unless the environment names its simulator; see ``arduplane.py`` and ``px4.py``.
"""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
from pathlib import Path

import pytest

from tests.flows import arduplane, px4
from tests.flows.flying import EXAMPLES

HOME = (-117.7514038, 33.4860851)
ARDUPLANE_SPEEDUP = 20.0
PX4_SPEEDUP = 5.0
LIMIT_S = 900


def journey(autopilot: str, address: str, service: str, folder: Path) -> str:
    """What the script writes; it must end well."""
    done = subprocess.run(
        ["sh", str(EXAMPLES.parent / "docker" / "journey.sh"), autopilot, address],
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
        env=os.environ | {"SERVICE": service, "JOURNEY_FOLDER": str(folder)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def judge(told: str, autopilot: str, folder: Path) -> None:
    """Read back equal, landed, on its lines, every region seen, and a report to show."""
    assert f"vehicle: {autopilot} fixed_wing" in told
    assert "upload: accepted, read back equal: True" in told
    assert "landed, disarmed" in told
    off_m = [float(number) for number in re.findall(r"([0-9.]+) m off the line", told)]
    assert len(off_m) == 8
    assert max(off_m) < 5.0
    seen = json.loads(told.rsplit("seen: ", 1)[1].replace("'", '"'))
    assert set(seen) == {"R1", "R2", "R3", "R4", "R5", "R6"}
    assert min(seen.values()) > 0.99
    assert "R1" in (folder / "swathplan-report.html").read_text()


@pytest.mark.ardupilot
@pytest.mark.skipif(not arduplane.BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator")
def test_with_arduplane(service: str, tmp_path: Path) -> None:
    """The whole journey over HTTP in a real ArduPlane."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with arduplane.arduplane(tmp_path, port, HOME, ARDUPLANE_SPEEDUP):
        told = journey("ardupilot", f"udpin:127.0.0.1:{port}", service, tmp_path)
    judge(told, "ardupilot", tmp_path)


@pytest.mark.px4
@pytest.mark.skipif(not (px4.BINARY and px4.ROMFS), reason="SWATHPLAN_PX4 and SWATHPLAN_PX4_ROMFS name none")
def test_with_px4(service: str, tmp_path: Path) -> None:
    """The whole journey over HTTP in a real PX4."""
    instance = px4.free_instance()
    with px4.px4(tmp_path, instance, HOME, PX4_SPEEDUP):
        told = journey("px4", f"udpin:127.0.0.1:{px4.FIRST_PORT + instance}", service, tmp_path)
    judge(told, "px4", tmp_path)


def test_the_script_says_how_it_is_used() -> None:
    """Without an autopilot, or with one that there is no simulator of, it does nothing and says so."""
    script = str(EXAMPLES.parent / "docker" / "journey.sh")
    for arguments in ([], ["betaflight"]):
        done = subprocess.run(["sh", script, *arguments], capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert "usage: sh docker/journey.sh ardupilot|px4" in done.stderr
