"""Names and addresses of machines."""

from __future__ import annotations

import ipaddress


def is_loopback(host: str) -> bool:
    """Whether a host name or address means this machine alone."""
    if host == "localhost" or host.endswith(".localhost"):
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def is_place(text: str) -> bool:
    """Whether a text is the name of a host, its address, or a network of them."""
    try:
        ipaddress.ip_network(text)
    except ValueError:
        return bool(text) and not set(text) & set("/:*[] ")
    return True
