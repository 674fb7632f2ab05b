"""Wrong usage, wrong input and what fails: told with thing, rule and fix."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

import pytest

from app.routers.bodies import EXAMPLE
from tests.app.cli.conftest import Command


@pytest.mark.parametrize(
    ("arguments", "stdin"),
    [
        (("plan", "-"), "{"),
        (("plan", "-"), '{"altitude_m": NaN}'),
        (("plan", "-"), "[]"),
        (("plan", "no-such-file"), ""),
        (("plan", "-", "--method", "transit"), "{}"),
        (("plan",), ""),
        (("plan", "-", "--no-such-option"), ""),
        (("export", "-"), json.dumps(EXAMPLE)),
        (("upload", "-", "--to", "sim:"), "{}"),
        (("download", "--from", "nonsense"), ""),
        (("download", "--from", "udpin:127.0.0.1:port"), ""),
        (("download", "--from", "tcp:127.0.0.1:99999"), ""),
        (("download", "--from", "serial:/dev/ttyUSB0:0"), ""),
        (("download", "--from", "replay:flight.tlog?speedup=-1"), ""),
        (("download", "--from", "sim:?airspeed=300"), ""),
        (("sim", "--url", "nonsense"), ""),
        (("sim", "--url", "udpout:127.0.0.1:99999"), ""),
        (("sim", "--url", "replay:flight.tlog"), ""),
        (("serve", "--sim-url", "sim:?wind=-3,270"), ""),
        (("serve", "--sim-url", "udpin:127.0.0.1:14550"), ""),
        (("serve", "--port", "99999"), ""),
        (("bench", "no-such"), ""),
        (("serve", "--host", "0.0.0.0"), ""),
    ],
)
def test_bad_usage_and_input_exit_2(swathplan: Command, arguments: tuple[str, ...], stdin: str) -> None:
    """Bad usage and bad input exit with 2, a message on standard error and nothing on standard output."""
    ended = swathplan(*arguments, stdin=stdin)
    assert ended.code == 2
    assert ended.out == ""
    assert ended.err
    assert "Traceback" not in ended.err


def without_regions() -> str:
    """The example without its regions."""
    return json.dumps(
        EXAMPLE | {"features": [f for f in EXAMPLE["features"] if f["properties"]["role"] != "roi"]}
    )


def exchanged() -> str:
    """The example, west of 90° W, with latitude first."""

    def turned(value: Any) -> Any:
        if isinstance(value[0], list):
            return [turned(item) for item in value]
        return [value[1], value[0]]

    features = [
        feature
        | {"geometry": feature["geometry"] | {"coordinates": turned(feature["geometry"]["coordinates"])}}
        for feature in EXAMPLE["features"]
    ]
    return json.dumps(EXAMPLE | {"features": features})


@pytest.mark.parametrize(
    ("arguments", "stdin", "code", "words"),
    [
        (("validate", "-"), '{"type": }', 2, ("standard input", "line 1, column 10", "json-syntax", "mend")),
        (("validate", "-"), "<kml/>", 2, ("looks like XML", "json-syntax", "swathplan import")),
        (("validate", "-"), "", 2, ("is empty", "json-syntax", "FeatureCollection")),
        (("validate", "-"), without_regions(), 2, ("scenario", "no-region", "Add a feature of role roi")),
        (("validate", "-"), exchanged(), 2, ("scenario", "axes-swapped", "write [longitude, latitude]")),
        (
            ("validate", "-"),
            json.dumps(EXAMPLE | {"altitude_m": 0.01}),
            2,
            ("altitude_m is 0.01", "out-of-range", "≥ 1"),
        ),
        (("validate", "-"), json.dumps(EXAMPLE | {"altitude_m": 4}), 0, ("many-passes", "Fly higher")),
        (
            ("plan", "-", "--method", "routing=magic"),
            json.dumps(EXAMPLE),
            2,
            ("method", "unknown-value", "Use one of: auto, joint"),
        ),
        (
            ("plan", "-"),
            json.dumps(EXAMPLE | {"method": "magic"}),
            2,
            ("method", "bad-value", "Write method"),
        ),
        (
            ("download", "--from", "http://127.0.0.1:8000"),
            "",
            2,
            ("not the service's", "link-address", "udpin:"),
        ),
        (("download", "--from", "tcp:127.0.0.1:1"), "", 1, ("tcp:127.0.0.1:1", "start the simulator")),
        (
            ("download", "--from", "udpin:127.0.0.1:0", "--timeout-s", "0.1"),
            "",
            1,
            ("no autopilot was heard on udpin:127.0.0.1:0", "does it send to this port"),
        ),
    ],
)
def test_likely_mistakes_are_told_with_thing_rule_and_fix(
    swathplan: Command, arguments: tuple[str, ...], stdin: str, code: int, words: tuple[str, ...]
) -> None:
    """Each names what is wrong, by which rule, and what to do."""
    ended = swathplan(*arguments, stdin=stdin)
    assert ended.code == code
    for word in words:
        assert word in ended.out + ended.err


def test_upload_names_what_is_wrong_with_the_address(swathplan: Command, plan_file: Path) -> None:
    """A good plan and an address that no try will open: 2, and the reason."""
    ended = swathplan("upload", str(plan_file), "--to", "udpin:127.0.0.1:99999")
    assert (ended.code, ended.out) == (2, "")
    assert "port 99999 is not in 0 to 65535" in ended.err


def test_ports_in_use_exit_1(swathplan: Command) -> None:
    """The address is good and the port another's: 1, with the port, as another try may do better."""
    with (
        socket.create_server(("127.0.0.1", 0)) as listener,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken,
    ):
        taken.bind(("127.0.0.1", 0))
        port, udp_port = str(listener.getsockname()[1]), str(taken.getsockname()[1])
        for arguments, number in (
            (("sim", "--url", f"tcpin:127.0.0.1:{port}"), port),
            (("download", "--from", f"udpin:127.0.0.1:{udp_port}"), udp_port),
        ):
            ended = swathplan(*arguments)
            assert ended.code == 1, arguments
            assert number in ended.err
            assert "in use" in ended.err


def test_what_fails_exits_1(swathplan: Command, scenario_file: Path, tmp_path: Path) -> None:
    """A result that cannot be written and a vehicle that is not there exit with 1."""
    assert swathplan("plan", str(scenario_file), "-o", str(tmp_path / "no" / "plan")).code == 1
    silent = swathplan("download", "--from", "udpin:127.0.0.1:0", "--timeout-s", "0.2")
    assert silent.code == 1
    assert "no autopilot" in silent.err
