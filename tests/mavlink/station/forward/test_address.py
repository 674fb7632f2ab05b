"""Addresses to forward to, and pairs that would send frames round for ever."""

from __future__ import annotations

import pytest

from mavlink.errors import AddressError
from mavlink.station.forward.address import ForwardAddress, looped, parse_forward


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("udpout:127.0.0.1:14550", "udpout:127.0.0.1:14550"),
        ("udpout:14550", "udpout:127.0.0.1:14550"),
        ("udpin::0", "udpin:127.0.0.1:0"),
        ("tcpin:5760", "tcpin:127.0.0.1:5760"),
        ("tcpin:0.0.0.0:5760", "tcpin:0.0.0.0:5760"),
        ("tcp:ground.example:5760", "tcp:ground.example:5760"),
        ("udpout:[::1]:14550", "udpout:[::1]:14550"),
    ],
)
def test_without_a_host_it_is_this_machine(given: str, meant: str) -> None:
    """A host is taken only where it is written; nothing is writable by itself."""
    assert parse_forward(given) == ForwardAddress(meant, write=False)


@pytest.mark.parametrize(
    "url",
    [
        "",
        "14550",
        "udpout",
        "udpout:",
        "udpout:0",
        "udpout:host",
        "udpout:no..host:14550",
        "udpin:x",
        "udp:127.0.0.1:14550",
        "tcpin:70000",
        "serial:/dev/ttyS0:57600",
        "sim:",
        "replay:flight.tlog",
    ],
)
def test_others_are_refused(url: str) -> None:
    """What is malformed, or no network address, is an AddressError."""
    with pytest.raises(AddressError):
        parse_forward(url)


@pytest.mark.parametrize(
    ("vehicles", "forwards", "meet"),
    [
        (["udpin:127.0.0.1:14550"], ["udpout:127.0.0.1:14550"], True),
        (["udpin:0.0.0.0:14550"], ["udpout:localhost:14550"], True),
        (["udpout:127.0.0.1:5000"], ["udpin:127.0.0.1:5000"], True),
        (["tcp:127.0.0.1:5760"], ["tcpin:127.0.0.1:5760"], True),
        (["sim:"], ["udpout:127.0.0.1:5000", "udpin:127.0.0.1:5000"], True),
        (["udpin:192.0.2.7:14550"], ["udpout:192.0.2.7:14550"], True),
        (["udpin:127.0.0.1:14550"], ["udpout:192.0.2.7:14550"], False),
        (["udpin:127.0.0.1:14550"], ["tcp:127.0.0.1:14550"], False),
        (["udpin:127.0.0.1:14550"], ["udpout:127.0.0.1:14551", "tcpin:127.0.0.1:14550"], False),
        (["udpin:127.0.0.1:5000", "udpout:127.0.0.1:5000"], [], False),
        (
            ["serial:/dev/ttyS0:57600", "replay:a.tlog", "udpin:x", "pigeon:post"],
            ["udpout:127.0.0.1:14550"],
            False,
        ),
    ],
)
def test_loops_are_found(vehicles: list[str], forwards: list[str], meet: bool) -> None:
    """A forward that calls a port listened on here, or is called from here, is named with the other."""
    found = looped(vehicles, [parse_forward(url) for url in forwards])
    assert (found is not None) is meet
    if found is not None:
        assert set(found) <= {*vehicles, *forwards}
        assert set(found) & set(forwards)
