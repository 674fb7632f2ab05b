"""Which kind of aircraft the settings name."""

from __future__ import annotations

from mavlink.sim.craft import Craft
from mavlink.sim.rotors import Multirotor
from mavlink.sim.settings import SimSettings
from mavlink.sim.wings import FixedWing


def craft_of(settings: SimSettings) -> Craft:
    """The manoeuvres of the aircraft simulated."""
    return Multirotor(settings) if settings.hovers else FixedWing(settings)
