"""Puts a simulated aircraft on a link, in real time or faster."""

from __future__ import annotations

import argparse
import asyncio
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path

from mavlink.errors import CodecError, LinkError
from mavlink.links.link import Link, PacedLink, open_link, parse_address
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.faults import Fault
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.replies import status_text
from mavlink.sim.settings import SimSettings
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from mavlink.wire.signing import Signing, SigningKey, parse_key

_TICK_S = 0.01
# A slower machine flies slower instead of falling ever further behind.
_LONGEST_TICK_S = 0.05
_DATAGRAM_BYTES = 1200


async def serve(
    url: str, settings: SimSettings, *, speedup: float | None = None, stop: asyncio.Event | None = None
) -> None:
    """Fly a simulated aircraft on a link until told to stop.

    Parameters
    ----------
    url
        As ``open_link`` takes it, e.g. ``udpout:127.0.0.1:14550`` to call a ground station.
    speedup
        Simulated seconds per second in flight; None: as the settings say.

    Raises
    ------
    LinkError
        The link cannot be opened, or has failed.
    """
    link = await open_link(url)
    try:
        await serve_link(link, settings, speedup=speedup, stop=stop)
    finally:
        await link.close()


async def serve_link(
    link: Link, settings: SimSettings, *, speedup: float | None = None, stop: asyncio.Event | None = None
) -> None:
    """The same on a link that is open already, and stays so."""
    if speedup is not None:
        settings = replace(settings, speedup=speedup)
    if settings.started_unix_s == 0.0:
        settings = replace(settings, started_unix_s=time.time())
    codec = Codec(settings.system_id, settings.component_id)
    if settings.signing_key:
        codec.signing = Signing(SigningKey(settings.signing_key), time.time)
    session = _Session(link, SimulatedAircraft(settings), codec)
    stop = stop or asyncio.Event()
    tasks = [
        asyncio.create_task(session.listen()),
        asyncio.create_task(session.fly()),
        asyncio.create_task(stop.wait()),
    ]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            task.result()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


class _Session:
    """One aircraft on one link. Its clock is the machine's, less what the machine was too slow for."""

    def __init__(self, link: Link, aircraft: SimulatedAircraft, codec: Codec) -> None:
        self._link = link
        self._aircraft = aircraft
        self._codec = codec
        self._others: dict[tuple[int, int], Codec] = {}
        self._now_s = 0.0
        self._paced = link if isinstance(link, PacedLink) else None

    async def listen(self) -> None:
        while True:
            data = await self._link.receive()
            answers: list[Message] = []
            for message in self._codec.feed(data):
                if message.name == "SETUP_SIGNING":
                    answers += self._take_key(message)
                    continue
                try:
                    answers += self._aircraft.receive(message, self._now_s)
                except (KeyError, TypeError, ValueError, OverflowError) as error:
                    # Nonsense from the link must not down the aircraft.
                    _say(f"{message.name} ignored: {error!r}")
            await self._send(answers)

    def _take_key(self, message: Message) -> list[Message]:
        """Sign with this key from now on, or no more: as ArduPilot, not while armed, and not for another."""
        if message.integer("target_system") != self._codec.system_id:
            return []
        if self._aircraft.armed:
            return [status_text(3, "ERROR: Won't setup signing when armed")]
        secret = message.fields["secret_key"]
        assert isinstance(secret, tuple)
        key = bytes(int(byte) for byte in secret)
        self._codec.signing = Signing(SigningKey(key), time.time) if any(key) else None
        return []

    async def fly(self) -> None:
        clock = asyncio.get_running_loop().time
        last_s = clock()
        while True:
            await asyncio.sleep(_TICK_S)
            now_s = clock()
            if self._paced is not None and self._paced.waiting_bytes > 0:
                # A slower listener, too: nothing is sent faster than it is heard, where the link can tell.
                last_s = now_s
                continue
            self._now_s += min(now_s - last_s, _LONGEST_TICK_S)
            last_s = now_s
            await self._send(self._aircraft.advance(self._now_s))

    async def _send(self, messages: list[Message]) -> None:
        """Pack many frames into few datagrams: fast flights would else spend their time in system calls."""
        batch = bytearray()
        for message in messages:
            try:
                frame = self._codec_of(message).pack(message)
            except CodecError as error:
                _say(f"{message.name} not sent: {error}")
                continue
            if batch and len(batch) + len(frame) > _DATAGRAM_BYTES:
                await self._link.send(bytes(batch))
                batch.clear()
            batch += frame
        if batch:
            await self._link.send(bytes(batch))

    def _codec_of(self, message: Message) -> Codec:
        """The sender's: the autopilot's, a component's, or that of a station that meddles."""
        named = message.system_id, message.component_id
        if message.system_id == 0 or named == (self._codec.system_id, self._codec.component_id):
            return self._codec
        other = self._others.setdefault(named, Codec(*named))
        other.signing = self._codec.signing if message.system_id == self._codec.system_id else None
        return other


def parser() -> argparse.ArgumentParser:
    """The command line of ``swathplan sim`` and ``python -m mavlink.sim``."""
    defaults = SimSettings()
    p = argparse.ArgumentParser(
        prog="swathplan sim",
        description=(
            "A simulated fixed wing or multirotor with an ArduPilot- or PX4-like autopilot on a MAVLink link."
        ),
    )
    p.add_argument("--url", default="udpout:127.0.0.1:14550", help="link address (default: %(default)s)")
    p.add_argument(
        "--home",
        type=_home,
        default=defaults.home,
        metavar="LAT,LON,ALT",
        help="where it stands: degrees, degrees, metres above sea level (default: 47.3977,8.5456,488)",
    )
    p.add_argument(
        "--heading",
        type=float,
        default=None,
        help="heading on the ground, degrees (default: at the take-off)",
    )
    p.add_argument("--autopilot", choices=[f.value for f in Flavour], default=Flavour.ARDUPILOT.value)
    p.add_argument(
        "--type",
        choices=["fixed_wing", "multirotor", "vtol"],
        default="fixed_wing",
        help="what flies (default: %(default)s); a vtol is refused: its transitions are not simulated",
    )
    p.add_argument("--system-id", type=int, default=1)
    p.add_argument("--airspeed", type=float, default=20.0, metavar="M_S")
    p.add_argument(
        "--turn-radius",
        type=float,
        default=100.0,
        metavar="M",
        help="loiter radius, flown with bank to spare",
    )
    p.add_argument("--max-bank", type=float, default=None, metavar="DEG")
    p.add_argument(
        "--climb", type=float, default=0.0, metavar="M_S", help="climbs at most; 0: as its autopilot comes"
    )
    p.add_argument(
        "--l1-period", type=float, default=None, metavar="S", help="lateral guidance; small is tight"
    )
    p.add_argument("--acceptance", type=float, default=0.0, metavar="M", help="waypoint acceptance distance")
    p.add_argument("--speedup", type=float, default=1.0, help="simulated seconds per second in flight")
    p.add_argument("--wind", type=_wind, default=(0.0, 0.0), metavar="M_S,FROM_DEG")
    p.add_argument("--gust", type=float, default=0.0, metavar="M_S", help="standard deviation of gusts")
    p.add_argument(
        "--dynamics",
        choices=["auto", "kinematic", "jsbsim"],
        default="auto",
        help="auto: JSBSim's c172p at 38-60 m/s where installed, kinematic otherwise (so also at 20 m/s)",
    )
    p.add_argument(
        "--sensor-reports",
        choices=["yes", "no"],
        default="yes",
        help="whether the sensor says by itself that it is on, as NAMED_VALUE_INT SAR_ON (default: yes)",
    )
    p.add_argument(
        "--camera-interval",
        type=float,
        default=0.0,
        metavar="S",
        help="shortest time between two photos (default: none)",
    )
    p.add_argument("--battery-wh", type=float, default=defaults.battery_wh)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument(
        "--signing-key",
        type=_key,
        default=b"",
        metavar="FILE",
        help="sign with the key in this file from the start, and hear nothing that is not signed with it",
    )
    p.add_argument(
        "--fault",
        action="append",
        default=[],
        choices=[fault.value for fault in Fault],
        help="a fault to show; may be repeated",
    )
    return p


def settings_of(arguments: argparse.Namespace) -> SimSettings:
    """Settings of a parsed command line. Raises ValueError when they contradict each other."""
    return SimSettings(
        home=arguments.home,
        heading_deg=arguments.heading,
        autopilot=Flavour(arguments.autopilot),
        vehicle_type=arguments.type,
        system_id=arguments.system_id,
        airspeed_m_s=arguments.airspeed,
        turn_radius_m=arguments.turn_radius,
        max_bank_deg=arguments.max_bank,
        climb_m_s=arguments.climb,
        l1_period_s=arguments.l1_period,
        acceptance_m=arguments.acceptance,
        wind_m_s=arguments.wind[0],
        wind_from_deg=arguments.wind[1],
        gust_m_s=arguments.gust,
        seed=arguments.seed,
        speedup=arguments.speedup,
        dynamics=arguments.dynamics,
        battery_wh=arguments.battery_wh,
        camera_interval_s=arguments.camera_interval,
        sensor_reports=arguments.sensor_reports == "yes",
        signing_key=arguments.signing_key,
        faults=tuple(arguments.fault),
    )


def main(argv: list[str] | None = None) -> int:
    """Run until SIGINT or SIGTERM. Exit codes: 0 stopped, 1 link or model failed, 2 bad usage."""
    p = parser()
    arguments = p.parse_args(argv)
    try:
        settings = settings_of(arguments)
        if not arguments.url.startswith("replay:"):
            parse_address(arguments.url)
        else:
            p.error("a recording cannot be flown on")
    except ValueError as error:
        p.error(str(error))
    try:
        asyncio.run(_run(arguments.url, settings))
    except (LinkError, OSError, ImportError) as error:
        _say(str(error))
        return 1
    return 0


async def _run(url: str, settings: SimSettings) -> None:
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stop.set)
    _say(
        f"{settings.autopilot.value} {settings.vehicle_type.replace('_', ' ')}, "
        f"{settings.flight_model} dynamics, "
        f"{settings.airspeed_m_s:g} m/s, {settings.speedup:g} times real time in flight, on {url}"
    )
    await serve(url, settings, stop=stop)


def _home(text: str) -> Place:
    parts = [float(part) for part in text.split(",")]
    if len(parts) != 3 or not (abs(parts[0]) <= 90.0 and abs(parts[1]) <= 180.0):
        raise argparse.ArgumentTypeError(f"{text!r} is not latitude,longitude,altitude")
    return Place(*parts)


def _key(name: str) -> bytes:
    try:
        return parse_key(Path(name).read_text(encoding="utf-8")).reveal()
    except (OSError, ValueError) as error:
        raise argparse.ArgumentTypeError(f"{name}: {error}") from error


def _wind(text: str) -> tuple[float, float]:
    parts = [float(part) for part in text.split(",")]
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text!r} is not speed,from")
    return parts[0], parts[1]


def _say(text: str) -> None:
    sys.stderr.write(f"sim: {text}\n")
    sys.stderr.flush()
