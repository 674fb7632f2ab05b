"""A PX4 simulator without graphics, if the machine has one, and a flight in it.

``SWATHPLAN_PX4`` names the binary (SITL with the built-in SIH model), ``SWATHPLAN_PX4_ROMFS`` its ``etc``
folder. PX4 sends to port 14540 plus its instance on loopback, where the test listens.
"""

from __future__ import annotations

import asyncio
import json
import lzma
import math
import os
import socket
import subprocess
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

from mavlink.encoding.options import DEFAULT_PAYLOAD
from mavlink.encoding.payload import Payload
from mavlink.links.link import open_link
from mavlink.station.client import VehicleClient
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from tests.flows.flying import Flight, until_disarmed
from tests.patience import PATIENCE_S

BINARY = os.environ.get("SWATHPLAN_PX4", "")
ROMFS = os.environ.get("SWATHPLAN_PX4_ROMFS", "")
FIRST_PORT = 14540
HOME_ALTITUDE_M = 30.0
#: Airframes of the SIH model.
AEROPLANE, MULTIROTOR, VTOL = "10041", "10040", "10043"
#: Nobody holds a remote control (NAV_RCL_ACT, COM_RCL_EXCEPT: mission, hold); output 5 follows actuator 1, so
#: that the simulator tells when the sensor is on; nothing is logged (SDLOG_MODE).
PARAMETERS: Mapping[str, float] = {
    "NAV_RCL_ACT": 0,
    "COM_RCL_EXCEPT": 7,
    "PWM_MAIN_FUNC5": 301,
    "SDLOG_MODE": -1,
}
#: Sent up to fifty times a second of the simulator's time, which runs fast; nobody here reads them.
NOT_NEEDED = (31, 32, 62, 83, 85, 105, 132, 141, 331)
SET_INTERVAL = 511
#: PX4's port for the link to ground stations, one more for each instance.
FIRST_STATION_PORT = 18570
REAL32 = 9  # MAV_PARAM_TYPE
CALM_BELOW_M = 50.0
#: Until position and attitude have settled.
READY_S = 60.0


def has_module(name: str) -> bool:
    """Whether the simulator was built with a module: each has a command of its own beside the binary."""
    return Path(BINARY).resolve().with_name(f"px4-{name}").exists()


def has_parameter(name: str) -> bool:
    """Whether the simulator has a parameter, by what it carries about itself."""
    packed = Path(ROMFS) / "extras/parameters.json.xz"
    if not (ROMFS and packed.is_file()):
        return False
    known = json.loads(lzma.decompress(packed.read_bytes()))["parameters"]
    return any(parameter["name"] == name for parameter in known)


def free_instance() -> int:
    """The first of PX4's instances whose port nobody listens to."""
    for instance in range(10):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("127.0.0.1", FIRST_PORT + instance))
            except OSError:
                continue
            return instance
    raise OSError("ports 14540 to 14549 are all in use")


@contextmanager
def px4(
    folder: Path,
    instance: int,
    home: tuple[float, float],
    speedup: float = 1.0,
    parameters: Mapping[str, float] = PARAMETERS,
    airframe: str = AEROPLANE,
) -> Iterator[subprocess.Popen[bytes]]:
    """Run the simulator in a folder of its own; ``home`` is (lon, lat)."""
    environment = {
        **{f"PX4_PARAM_{name}": f"{value:g}" for name, value in parameters.items()},
        "PATH": f"{Path(BINARY).resolve().parent}:{os.environ['PATH']}",
        "PX4_SYS_AUTOSTART": airframe,
        "PX4_SIMULATOR": "sihsim",
        "PX4_SIM_SPEED_FACTOR": f"{speedup:g}",
        "PX4_HOME_LON": f"{home[0]:.7f}",
        "PX4_HOME_LAT": f"{home[1]:.7f}",
        "PX4_HOME_ALT": f"{HOME_ALTITUDE_M:g}",
    }
    command = [BINARY, "-d", "-i", str(instance), "-w", str(folder), str(Path(ROMFS).resolve())]
    with (folder / "output.txt").open("wb") as output:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdout=output,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
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
async def simulated(
    folder: Path,
    home: tuple[float, float],
    speedup: float,
    parameters: Mapping[str, float] = PARAMETERS,
    airframe: str = AEROPLANE,
) -> AsyncIterator[VehicleClient]:
    """A simulator that is ready to fly, and a client of it."""
    instance = free_instance()
    link = await open_link(f"udpin:127.0.0.1:{FIRST_PORT + instance}")
    async with VehicleClient(link) as client:
        with px4(folder, instance, home, speedup, parameters, airframe):
            await client.connect(30.0)
            await client.wait_for(lambda state: state.home_lat_deg is not None, READY_S)
            for message_id in NOT_NEEDED:
                await client.command(SET_INTERVAL, (float(message_id), -1.0))
            yield client


@asynccontextmanager
async def wind(client: VehicleClient, speed_m_s: float, from_deg: float) -> AsyncIterator[None]:
    """A steady wind in the simulator (SIH_WIND_N, SIH_WIND_E: where it comes from), by the vehicle's height.

    None on the ground, where SIH's aeroplane has no friction and would be blown along; all from 150 m on.
    """
    codec = Codec(254, 190)
    # The link that PX4 keeps for ground stations, by instance; its system id is one more.
    station = ("127.0.0.1", FIRST_STATION_PORT + client.state.system_id - 1)
    north, east = math.cos(math.radians(from_deg)), math.sin(math.radians(from_deg))

    async def blow(sender: socket.socket) -> None:
        set_m_s = 0.0
        while True:
            part = ((client.state.relative_altitude_m or 0.0) - CALM_BELOW_M) / CALM_BELOW_M / 2.0
            wanted_m_s = speed_m_s * min(max(part, 0.0), 1.0)
            # In steps, but to both ends exactly.
            if wanted_m_s != set_m_s and (abs(wanted_m_s - set_m_s) >= 0.5 or part <= 0.0 or part >= 1.0):
                set_m_s = wanted_m_s
                for name, value in (("SIH_WIND_N", north * set_m_s), ("SIH_WIND_E", east * set_m_s)):
                    fields = {"target_system": client.state.system_id, "target_component": 1}
                    typed = {"param_id": name, "param_value": value, "param_type": REAL32}
                    sender.sendto(codec.pack(Message("PARAM_SET", {**fields, **typed})), station)
            await asyncio.sleep(0.1)

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        blowing = asyncio.create_task(blow(sender))
        try:
            yield
        finally:
            blowing.cancel()
            await asyncio.gather(blowing, return_exceptions=True)


async def fly(client: VehicleClient, payload: Payload = DEFAULT_PAYLOAD) -> Flight:
    """Start the mission, which arms PX4, and wait until the vehicle has landed and disarmed."""
    output = await client.sensor_output(payload)
    assert output is not None
    recorder = client.start_recording(output)
    for _ in range(120):
        started = await client.start_mission()
        if started.accepted:
            break
        await asyncio.sleep(0.5)
    assert started.accepted, (started, [text.text for text in client.state.texts])
    await client.wait_for(lambda state: state.armed, PATIENCE_S)
    texts = await until_disarmed(client)
    client.stop_recording(recorder)
    return Flight(recorder.track(), texts, client.state)
