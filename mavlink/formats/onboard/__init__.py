"""Logs kept aboard: ArduPilot's ``.bin``, PX4's ``.ulg``; and recordings of the link, ``.tlog``."""

from __future__ import annotations

from mavlink.formats.onboard.log import OnboardLog, Switch, switch_of
from mavlink.formats.onboard.reading import read_log

__all__ = ["OnboardLog", "Switch", "read_log", "switch_of"]
