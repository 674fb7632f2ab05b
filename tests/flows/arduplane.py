"""An ArduPlane simulator, if the machine has one, and a flight in it.

``SWATHPLAN_ARDUPLANE`` names the binary, ``SWATHPLAN_ARDUPLANE_PARAMS`` its default parameters (else
``plane.parm`` beside it; ``quadplane.parm`` there for the VTOL). It calls this side over UDP on loopback and
opens no port for others.
"""

from __future__ import annotations

import asyncio
import os
import subprocess
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

from mavlink.links.link import open_link
from mavlink.state.telemetry import VehicleState
from mavlink.station.client import VehicleClient
from tests.flows.flying import Flight, until_disarmed
from tests.patience import PATIENCE_S

BINARY = os.environ.get("SWATHPLAN_ARDUPLANE", "")
#: Relay 0 exists only where it is given a function; nobody holds a remote control.
PARAMETERS: Mapping[str, float] = {"RELAY1_FUNCTION": 1, "RELAY1_PIN": 13, "THR_FAILSAFE": 0}
HOME_ALTITUDE_M = 30.0
#: Arming is refused until position and attitude have settled: some 30 s of the simulator's time.
ARMING_TRIES = 240


#: The quadplane's own parameter file; there need not be one.
QUADPLANE = Path(BINARY or "arduplane").with_name("quadplane.parm")


def default_parameters(model: str) -> Path:
    """The vehicle's own parameter file."""
    if model == "quadplane":
        return QUADPLANE
    named = os.environ.get("SWATHPLAN_ARDUPLANE_PARAMS")
    return Path(named) if named else Path(BINARY).with_name("plane.parm")


def in_wind(wind: tuple[float, float] | None) -> Mapping[str, float]:
    """Its parameters, with a steady wind (m/s, where from) in the simulator."""
    return PARAMETERS if wind is None else {**PARAMETERS, "SIM_WIND_SPD": wind[0], "SIM_WIND_DIR": wind[1]}


@contextmanager
def arduplane(
    folder: Path,
    port: int,
    home: tuple[float, float],
    speedup: float = 1.0,
    parameters: Mapping[str, float] = PARAMETERS,
    model: str = "plane",
    binary: str = "",
    defaults: str = "",
    heading_deg: float = 0.0,
    serial1: str = "none",
) -> Iterator[subprocess.Popen[bytes]]:
    """Run the simulator in a folder of its own, calling a port on loopback.

    Its first port is its USB's, which takes unsigned frames whatever key it has; ``serial1`` is another one.
    It stands at ``home`` (lon, lat) and points to ``heading_deg``, in which direction it takes off.
    """
    own = folder / "own.parm"
    own.write_text("".join(f"{name} {value:g}\n" for name, value in parameters.items()))
    command = [
        binary or BINARY,
        "--synthetic-clock",
        "--wipe",
        *("--model", model),
        *("--speedup", f"{speedup:g}"),
        *("--home", f"{home[1]:.7f},{home[0]:.7f},{HOME_ALTITUDE_M:g},{heading_deg:g}"),
        *("--defaults", f"{(Path(defaults) if defaults else default_parameters(model)).resolve()},{own}"),
        *("--serial0", f"udpclient:127.0.0.1:{port}"),
        *("--serial1", serial1),
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


@asynccontextmanager
async def aeroplane(
    folder: Path,
    home: tuple[float, float],
    speedup: float,
    parameters: Mapping[str, float] = PARAMETERS,
    model: str = "plane",
    binary: str = "",
    defaults: str = "",
    heading_deg: float = 0.0,
) -> AsyncIterator[VehicleClient]:
    """A simulator that has booted, and a client of it; another binary and its parameters where named."""
    link = await open_link("udpin:127.0.0.1:0")
    port = int(link.url.rpartition(":")[2])
    with arduplane(folder, port, home, speedup, parameters, model, binary, defaults, heading_deg):
        async with VehicleClient(link) as client:
            await booted(client)
            yield client


async def booted(client: VehicleClient) -> VehicleState:
    """Wait for the heartbeat and the end of the boot, before which nothing can be stored."""
    await client.connect(30.0)
    return await client.wait_for(lambda state: state.mode not in ("", "INITIALISING"), PATIENCE_S)


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
    texts = await until_disarmed(client)
    client.stop_recording(recorder)
    return Flight(recorder.track(), texts, client.state)
