"""Links that requests may open: this machine alone, until whoever runs the service says more."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.services.errors import RefusedError
from app.services.vehicles.permits import Permits

WIDE = Permits(
    hosts=("192.168.1.0/24", "fd00::/8", "bridge.example"),
    serial_ports=("/dev/ttyACM*", "/dev/serial/by-id/usb-*"),
    replay_folders=(Path("/srv/logs"),),
    remote=True,
)

AT_HOME = [
    "udpin:127.0.0.1:14550",
    "udpin:[::1]:14550",
    "udpout:localhost:14550",
    "tcp:127.3.2.1:5760",
    "tcpin:127.0.0.1:0",
    "sim:",
    "sim:?speedup=2",
]
BEYOND = [
    "udpin:0.0.0.0:14550",
    "udpin:[::]:14550",
    "tcpin:192.168.1.5:5760",
    "udpout:192.168.1.7:14550",
    "tcp:bridge.example:5760",
    "tcp:BRIDGE.example:5760",
    "tcp:[fd00::7]:5760",
    "serial:/dev/ttyACM0:57600",
    "serial:/dev/serial/by-id/usb-radio:57600",
]
RECORDINGS = ["replay:/srv/logs/flight.tlog?speedup=2", "replay:/srv/logs/2026/flight.TLOG"]
NEVER = [
    "udpout:192.168.2.7:14550",
    "udpout:169.254.169.254:80",
    "tcp:other.example:5760",
    "tcp:bridge.example.evil.example:5760",
    "tcp:127.0.0.1.evil.example:80",
    "udpout:0:14550",
    "serial:/dev/ttyUSB0:57600",
    "serial:/dev/ttyACM0/../sda:57600",
    "serial:/dev/serial/by-id/usb-a/b:57600",
    "replay:/etc/passwd",
    "replay:/srv/logs/plans.db",
    "replay:/srv/logs/../../etc/a.tlog",
    "replay:/srv/logs-of-others/a.tlog",
]


def refused(permits: Permits, url: str) -> bool:
    """Whether an address is refused by the rule that says so, and the setting that allows it named."""
    try:
        permits.require(url)
    except RefusedError as error:
        (finding,) = error.findings
        return finding.rule == "link-not-allowed" and ("SWATHPLAN_" in finding.fix or ".tlog" in finding.fix)
    return False


@pytest.mark.parametrize("url", AT_HOME)
def test_this_machine_is_allowed(url: str) -> None:
    """Loopback and simulated aircraft need no word."""
    assert not refused(Permits(), url)
    assert not refused(WIDE, url)


@pytest.mark.parametrize("url", BEYOND)
def test_what_lies_beyond_has_to_be_allowed(url: str) -> None:
    """Other hosts, listening for them, serial ports and recordings are refused unless they are declared."""
    assert refused(Permits(), url)
    assert not refused(WIDE, url)


@pytest.mark.parametrize("url", RECORDINGS)
def test_recordings_are_files_called_so(url: str) -> None:
    """Without folders any, with folders those in them."""
    assert not refused(Permits(), url)
    assert not refused(WIDE, url)
    assert refused(Permits(replay_folders=(Path("/srv/other"),)), url)


@pytest.mark.parametrize("url", NEVER)
def test_nothing_near_what_is_allowed_passes(url: str) -> None:
    """Names that only look alike, paths that lead elsewhere, other networks."""
    assert refused(WIDE, url)


def test_a_kind_that_is_not_allowed_is_refused() -> None:
    """Also where its place would be."""
    few = Permits(kinds=("sim", "udpin"))
    assert not refused(few, "udpin:127.0.0.1:14550")
    assert refused(few, "tcp:127.0.0.1:5760")
    assert refused(few, "replay:flight.tlog")


def test_forwards_are_links_too() -> None:
    """Without a host they are on this machine; beyond it they have to be allowed."""
    Permits().require_forwards(["udpout:14550", "udpin::14550", "tcpin:127.0.0.1:5760", "no address"])
    for url in ("udpout:10.0.0.1:14550", "tcpin:0.0.0.0:5760"):
        with pytest.raises(RefusedError, match=r"10\.0\.0\.1|0\.0\.0\.0"):
            Permits().require_forwards([url])


@given(st.ip_addresses())
def test_calls_go_to_loopback_and_declared_networks_alone(address: object) -> None:
    """Judged by the standard library's own networks."""
    import ipaddress

    assert isinstance(address, ipaddress.IPv4Address | ipaddress.IPv6Address)
    host = f"[{address}]" if address.version == 6 else str(address)
    meant = address.is_loopback or any(
        address in ipaddress.ip_network(network) for network in ("192.168.1.0/24", "fd00::/8")
    )
    assert refused(WIDE, f"udpout:{host}:14550") != meant
