"""An ArduPlane simulator, if the machine has one, and a flight in it.

``SWATHPLAN_ARDUPLANE`` names the binary, ``SWATHPLAN_ARDUPLANE_PARAMS`` its default parameters (else
``plane.parm`` beside it). It calls this side over UDP on loopback and opens no port for others.
"""

from __future__ import annotations

import asyncio
import math
import os
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from mavlink.client import VehicleClient
from mavlink.telemetry import VehicleState
from mavlink.track import Track

BINARY = os.environ.get("SWATHPLAN_ARDUPLANE", "")
#: Relay 0 exists only where it is given a function; nobody holds a remote control.
PARAMETERS: Mapping[str, float] = {"RELAY1_FUNCTION": 1, "RELAY1_PIN": 13, "THR_FAILSAFE": 0}
HOME_ALTITUDE_M = 30.0
#: Arming is refused until position and attitude have settled: some 30 s of the simulator's time.
ARMING_TRIES = 240
STALLED_S = 60.0


def default_parameters() -> Path:
    """The vehicle's own parameter file."""
    named = os.environ.get("SWATHPLAN_ARDUPLANE_PARAMS")
    return Path(named) if named else Path(BINARY).with_name("plane.parm")


@contextmanager
def arduplane(
    folder: Path,
    port: int,
    home: tuple[float, float],
    speedup: float = 1.0,
    parameters: Mapping[str, float] = PARAMETERS,
) -> Iterator[subprocess.Popen[bytes]]:
    """Run the simulator in a folder of its own, calling a port on loopback; ``home`` is (lon, lat)."""
    own = folder / "own.parm"
    own.write_text("".join(f"{name} {value:g}\n" for name, value in parameters.items()))
    command = [
        BINARY,
        "--synthetic-clock",
        "--wipe",
        *("--model", "plane"),
        *("--speedup", f"{speedup:g}"),
        *("--home", f"{home[1]:.7f},{home[0]:.7f},{HOME_ALTITUDE_M:g},0"),
        *("--defaults", f"{default_parameters().resolve()},{own}"),
        *("--serial0", f"udpclient:127.0.0.1:{port}"),
        *("--serial1", "none"),
        *("--serial2", "none"),
        # Stick positions come from nowhere: any free port will do.
        *("--rc-in-port", "0"),
    ]
    with (folder / "output.txt").open("wb") as output:
        process = subprocess.Popen(
            command, cwd=folder, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
        )
        try:
            yield process
        finally:
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


@dataclass(frozen=True, slots=True)
class Flight:
    """A mission flown to its end."""

    track: Track
    texts: tuple[str, ...]
    final: VehicleState


async def booted(client: VehicleClient) -> VehicleState:
    """Wait for the heartbeat and the end of the boot, before which nothing can be stored."""
    await client.connect(30.0)
    return await client.wait_for(lambda state: state.mode not in ("", "INITIALISING"), 30.0)


async def arm(client: VehicleClient) -> None:
    """Arm as soon as the vehicle's own checks allow."""
    for _ in range(ARMING_TRIES):
        outcome = await client.command(400, (1.0,))
        if outcome.accepted:
            return
        await asyncio.sleep(0.25)
    raise AssertionError([text.text for text in client.state.texts])


async def fly(client: VehicleClient) -> Flight:
    """Arm, start the mission, and wait until the vehicle has landed and disarmed."""
    await arm(client)
    recorder = client.start_recording()
    started = await client.start_mission()
    assert started.accepted, started
    texts: list[str] = []
    last_seq, quiet_s = -1, 0.0
    while client.state.armed:
        await asyncio.sleep(0.05)
        state = client.state
        assert state.connected, "the simulator fell silent"
        texts += [text.text for text in state.texts if text.text not in texts]
        quiet_s = 0.0 if state.mission_current != last_seq else quiet_s + 0.05
        last_seq = state.mission_current if state.mission_current is not None else -1
        assert quiet_s < STALLED_S, f"stuck at item {last_seq}, mode {state.mode}: {texts[-5:]}"
    client.stop_recording(recorder)
    return Flight(recorder.track(), tuple(texts), client.state)


def distance_m(here: tuple[float, float], there: tuple[float, float]) -> float:
    """Distance between two near places, longitude and latitude in degrees."""
    east = math.radians(there[0] - here[0]) * math.cos(math.radians(here[1]))
    return 6_371_009.0 * math.hypot(east, math.radians(there[1] - here[1]))
