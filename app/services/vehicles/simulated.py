"""``sim:`` addresses: a simulated aircraft as a process of its own, on loopback."""

from __future__ import annotations

import asyncio
import contextlib
import math
import sys
from dataclasses import dataclass, replace
from typing import NoReturn
from urllib.parse import parse_qsl

from app.services.errors import LinkError, RefusedError
from mavlink.sim.faults import Fault
from mavlink.sim.geodesy import MOST_LATITUDE_DEG
from mavlink.sim.run import parser, settings_of
from planner.errors import Finding

#: How long a simulated aircraft may take to end by itself.
END_S = 3.0

#: Options of a ``sim:`` address and the flags of ``mavlink.sim`` they become.
_NUMBERS = {
    "speedup": "--speedup",
    "airspeed": "--airspeed",
    "turn_radius": "--turn-radius",
    "seed": "--seed",
    "heading": "--heading",
    "climb": "--climb",
    "gust": "--gust",
    "max_bank": "--max-bank",
    "l1_period": "--l1-period",
    "acceptance": "--acceptance",
    "battery_wh": "--battery-wh",
    "camera_interval": "--camera-interval",
}
_WORDS = {
    "autopilot": ("ardupilot", "px4"),
    "type": ("fixed_wing", "multirotor"),
    "dynamics": ("auto", "kinematic", "jsbsim"),
    "sensor_reports": ("yes", "no"),
    "fault": tuple(fault.value for fault in Fault),
}
FORM = "sim:?speedup=20&home=33.48,-117.75&autopilot=px4&type=multirotor&airspeed=12&wind=8,270"


@dataclass(frozen=True, slots=True)
class SimulatedAircraft:
    """What a ``sim:`` address asks for.

    Parameters
    ----------
    home
        Latitude, longitude in degrees and altitude above sea level in metres; None where the address does
        not say, then the aircraft stands wherever the plan it gets begins.
    arguments
        For ``mavlink.sim``, beside link and home.
    """

    home: tuple[float, float, float] | None = None
    arguments: tuple[str, ...] = ()

    def at(self, home: tuple[float, float, float] | None) -> SimulatedAircraft:
        """The same aircraft somewhere else."""
        return replace(self, home=home)


def _refuse(message: str) -> NoReturn:
    raise RefusedError(message, (Finding("url", "sim-address", message, f"write e.g. {FORM}"),))


def _floats(name: str, text: str, counts: tuple[int, ...]) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) not in counts or not all(map(math.isfinite, values)):
        _refuse(f"{name}={text} is not understood")
    return values


def parse_simulated(url: str) -> SimulatedAircraft:
    """Read a ``sim:`` address; raises RefusedError naming what is not understood."""
    _, _, query = url.partition(":")
    home: tuple[float, float, float] | None = None
    arguments: list[str] = []
    try:
        options = parse_qsl(query.lstrip("?"), strict_parsing=True) if query.strip("?") else []
    except ValueError:
        _refuse(f"{url} is not understood")
    for name, text in options:
        if name == "home":
            lat_deg, lon_deg, *altitude_m = _floats(name, text, (2, 3))
            if abs(lat_deg) > MOST_LATITUDE_DEG or abs(lon_deg) > 180:
                _refuse(f"home={text}: latitude first, then longitude, in degrees")
            home = (lat_deg, lon_deg, altitude_m[0] if altitude_m else 0.0)
        elif name == "wind":
            speed_m_s, from_deg = _floats(name, text, (2,))
            arguments.append(f"--wind={speed_m_s},{from_deg}")
        elif name in _NUMBERS:
            _floats(name, text, (1,))
            arguments.append(f"{_NUMBERS[name]}={text}")
        elif (name, text) == ("type", "vtol"):
            _refuse("no vtol is simulated: its transitions between rotors and wings are not")
        elif name in _WORDS:
            if text not in _WORDS[name]:
                _refuse(f"{name}={text}: {' or '.join(_WORDS[name])} is meant")
            arguments.append(f"--{name.replace('_', '-')}={text}")
        else:
            _refuse(f"a simulated aircraft has no option {name}")
    try:
        settings_of(parser().parse_args(arguments))
    except ValueError as error:
        _refuse(str(error))
    return SimulatedAircraft(home, tuple(arguments))


class SimulatorProcess:
    """One simulated aircraft at work."""

    def __init__(self, process: asyncio.subprocess.Process, reader: asyncio.Task[bytes]) -> None:
        self._process = process
        self._errors = reader

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    @classmethod
    async def start(cls, aircraft: SimulatedAircraft, port: int) -> SimulatorProcess:
        """Start an aircraft that talks to a loopback port."""
        arguments = ["--url", f"tcp:127.0.0.1:{port}", *aircraft.arguments]
        if aircraft.home is not None:
            arguments += ["--home=" + ",".join(repr(value) for value in aircraft.home)]
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-m",
            "app.services.vehicles.simulator",
            *arguments,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
        )
        assert process.stderr is not None
        return cls(process, asyncio.create_task(_tail(process.stderr)))

    async def wait(self) -> None:
        """Wait until it has ended."""
        await self._process.wait()

    async def raise_last_words(self) -> NoReturn:
        """Raise LinkError with what it said at its end."""
        words = (await self._errors).decode(errors="replace").strip().splitlines()
        reason = words[-1] if words else f"exit code {self._process.returncode}"
        raise LinkError(f"the simulated aircraft ended: {reason}")

    async def stop(self) -> None:
        """End it, by force when it does not listen."""
        if self._process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                self._process.terminate()
            try:
                async with asyncio.timeout(END_S):
                    await self._process.wait()
            except TimeoutError:
                with contextlib.suppress(ProcessLookupError):
                    self._process.kill()
                await self._process.wait()
        await self._errors


async def _tail(stream: asyncio.StreamReader, keep_bytes: int = 8192) -> bytes:
    """Read a stream to its end and keep the last of it."""
    kept = b""
    while chunk := await stream.read(4096):
        kept = (kept + chunk)[-keep_bytes:]
    return kept
