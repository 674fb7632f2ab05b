"""The simulated aircraft on a link: in this process, and as a process of its own over loopback."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import sys
from collections.abc import Callable
from itertools import pairwise

import pytest

from mavlink.links.link import Link, MemoryLink, memory_pair, open_link
from mavlink.links.memory import NO_FAULTS
from mavlink.sim.modes import Flavour
from mavlink.sim.run import main, parser, serve, serve_link, settings_of
from mavlink.sim.settings import SimSettings
from mavlink.wire.codec import Codec
from mavlink.wire.items import Command, MissionItem
from mavlink.wire.messages import Message
from tests.mavlink.sim.helpers import HOME, from_ground, item_message, landing_mission, numbered, waypoint
from tests.patience import PATIENCE_S


class Ground:
    """A ground station on a real link."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._codec = Codec(255, 190)
        self.heard: list[Message] = []

    async def say(self, message: Message) -> None:
        await self._link.send(self._codec.pack(message))

    async def until(self, wanted: Callable[[Message], bool]) -> Message:
        async with asyncio.timeout(PATIENCE_S):
            while True:
                messages = self._codec.feed(await self._link.receive())
                self.heard += messages
                for message in messages:
                    if wanted(message):
                        return message

    async def upload(self, rows: list[MissionItem]) -> int:
        await self.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
        while True:
            message = await self.until(lambda m: m.name in ("MISSION_REQUEST", "MISSION_ACK"))
            if message.name == "MISSION_ACK":
                return message.integer("type")
            await self.say(item_message(rows[message.integer("seq")]))

    async def command(self, command: int, *params: float) -> int:
        values = {f"param{n}": value for n, value in enumerate(params, 1)}
        await self.say(from_ground("COMMAND_LONG", command=command, **values))
        ack = await self.until(lambda m: m.name == "COMMAND_ACK" and m.integer("command") == command)
        return ack.integer("result")

    async def fly(self) -> None:
        """Upload, start and wait for the landing."""
        await self.until(lambda m: m.name == "HEARTBEAT")
        mission = numbered(landing_mission([waypoint(0.0, 1000.0)], home_row=True))
        assert await self.upload(mission) == 0
        assert await self.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
        assert await self.command(Command.MISSION_START) == 0
        await self.until(lambda m: m.name == "STATUSTEXT" and "Landed" in m.text("text"))
        reached = [m.integer("seq") for m in self.heard if m.name == "MISSION_ITEM_REACHED"]
        assert reached == list(range(1, len(mission)))


class Pipe(MemoryLink):
    """A link that says what has not gone out yet."""

    waiting_bytes = 0


@pytest.mark.virtual_time
async def test_time_stands_still_while_the_link_is_behind() -> None:
    """An aircraft faster than its listener waits for it, and loses no time of its own by that."""
    ours, theirs = MemoryLink("ground", NO_FAULTS, 0), Pipe("air", NO_FAULTS, 1)
    ours.join(theirs)
    theirs.join(ours)
    ground = Ground(ours)
    server = asyncio.create_task(serve_link(theirs, SimSettings(home=HOME)))
    await ground.until(lambda m: m.name == "GLOBAL_POSITION_INT")
    theirs.waiting_bytes = 1
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(0.1):
            await ours.receive()  # what was sent before
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.6):
            await ours.receive()
    theirs.waiting_bytes = 0
    await ground.until(lambda m: m.name == "GLOBAL_POSITION_INT")
    server.cancel()
    await asyncio.gather(server, return_exceptions=True)
    stamps = [m.integer("time_boot_ms") for m in ground.heard if m.name == "GLOBAL_POSITION_INT"]
    assert stamps[-1] - stamps[0] < 550


@pytest.mark.virtual_time
async def test_a_mission_is_flown_over_a_link_and_the_server_stops() -> None:
    """In one process, two hundred times faster than real time; then the stop event ends it."""
    ours, theirs = memory_pair()
    stop = asyncio.Event()
    server = asyncio.create_task(serve_link(theirs, SimSettings(home=HOME), speedup=200.0, stop=stop))
    ground = Ground(ours)
    await ground.fly()
    stop.set()
    await asyncio.wait_for(server, PATIENCE_S)
    stamps = [m.integer("time_boot_ms") for m in ground.heard if m.name == "GLOBAL_POSITION_INT"]
    assert max(b - a for a, b in pairwise(stamps)) < 400
    assert {m.system_id for m in ground.heard} == {1}


@pytest.mark.virtual_time
async def test_nonsense_on_the_link_does_not_end_it() -> None:
    """Noise and commands full of NaN are survived; the next question is answered."""
    ours, theirs = memory_pair()
    stop = asyncio.Event()
    server = asyncio.create_task(serve_link(theirs, SimSettings(home=HOME), stop=stop))
    ground = Ground(ours)
    # The zeros complete whatever frame the noise seems to have begun.
    await ours.send(bytes(range(256)) * 8 + bytes(300))
    nan = float("nan")
    assert await ground.command(Command.DO_SET_MODE, 1.0, nan) == 2
    assert await ground.command(Command.DO_SET_MISSION_CURRENT, nan) == 2
    await ground.say(from_ground("PARAM_REQUEST_READ", param_id="NOPE", param_index=999))
    assert await ground.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
    stop.set()
    await asyncio.wait_for(server, PATIENCE_S)


async def test_as_a_process_it_flies_and_stops_on_sigterm() -> None:
    """``python -m mavlink.sim`` calls a ground station over UDP, flies its mission and exits 0 on SIGTERM."""
    link = await open_link("udpin:127.0.0.1:0")
    port = link.url.rpartition(":")[2]
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        *("-m", "mavlink.sim", "--url", f"udpout:127.0.0.1:{port}", "--speedup", "100"),
        *("--home", "47.3977,8.5456,488", "--wind", "4,270", "--seed", "3"),
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
    )
    try:
        await Ground(link).fly()
        process.send_signal(signal.SIGTERM)
        out, err = await asyncio.wait_for(process.communicate(), PATIENCE_S)
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
        await link.close()
    assert process.returncode == 0
    assert out == b""
    assert b"kinematic dynamics" in err


async def test_serve_opens_and_closes_its_link() -> None:
    """A stop set beforehand ends it at once, and the port is free again."""
    stop = asyncio.Event()
    stop.set()
    link = await open_link("udpin:127.0.0.1:0")
    port = link.url.rpartition(":")[2]
    await link.close()
    for _ in range(2):
        await serve(f"udpin:127.0.0.1:{port}", SimSettings(home=HOME), stop=stop)


def test_options_become_settings() -> None:
    """Every option ends in the setting of its name."""
    line = (
        "--home 33.5,-117.7,20 --autopilot px4 --airspeed 25 --turn-radius 120 --wind 8,270 --gust 1 "
        "--speedup 60 --dynamics kinematic --seed 5 --fault no_final_ack --fault lost_items"
    )
    arguments = parser().parse_args(line.split())
    settings = settings_of(arguments)
    assert (settings.home.lat_deg, settings.home.lon_deg, settings.home.altitude_m) == (33.5, -117.7, 20.0)
    assert settings.autopilot is Flavour.PX4
    assert (settings.airspeed_m_s, settings.turn_radius_m, settings.speedup) == (25.0, 120.0, 60.0)
    assert (settings.wind_m_s, settings.wind_from_deg, settings.gust_m_s) == (8.0, 270.0, 1.0)
    assert (settings.dynamics, settings.seed) == ("kinematic", 5)
    assert settings.faults == ("no_final_ack", "lost_items")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--home", "200,0,0"], "latitude"),
        (["--home", "here"], "home"),
        (["--wind", "8"], "speed,from"),
        (["--type", "vtol"], "transitions"),
        (["--fault", "nonsense"], "no_final_ack"),
        (["--airspeed", "60", "--turn-radius", "100"], "bank"),
        (["--dynamics", "jsbsim"], "c172p"),
        (["--speedup", "0"], "speedup"),
        (["--url", "carrier-pigeon:1"], "carrier-pigeon"),
    ],
)
def test_bad_usage_exits_2_and_says_why(
    options: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Wrong options end with exit code 2 and a reason."""
    with pytest.raises(SystemExit) as ended:
        main(options)
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


def test_a_link_that_cannot_be_opened_exits_1(capsys: pytest.CaptureFixture[str]) -> None:
    """A port that is not to be had: exit code 1 and the reason, no traceback."""
    assert main(["--url", "tcp:127.0.0.1:1"]) == 1
    assert "tcp:127.0.0.1:1" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "rates_m_s"),
    [
        ([], (5.0, 5.0)),
        (["--type=multirotor"], (2.5, 1.5)),
        (["--autopilot=px4"], (3.0, 2.0)),
        (["--autopilot=px4", "--type=multirotor"], (3.0, 1.5)),
        (["--type=multirotor", "--climb=4"], (4.0, 1.5)),
    ],
)
def test_it_climbs_as_its_autopilot_comes(words: list[str], rates_m_s: tuple[float, float]) -> None:
    """TECS_CLMB_MAX, WPNAV_SPEED_UP, FW_T_CLMB_R_SP, MPC_Z_V_AUTO_UP by default, and what is asked for."""
    settings = settings_of(parser().parse_args(words))
    assert (settings.climb_m_s, settings.sink_m_s) == rates_m_s
