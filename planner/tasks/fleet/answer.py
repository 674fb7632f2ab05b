"""The answer of a task of several aircraft."""

from __future__ import annotations

from dataclasses import dataclass, replace

from planner.errors import Finding
from planner.plan import Assigned, LeftOut
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flown import Flown
from planner.tasks.fleet.placing import Sortie
from planner.tasks.task import Answer
from planner.wishes import Separation


@dataclass(frozen=True, slots=True)
class FleetAnswer:
    """What several aircraft are to fly.

    Parameters
    ----------
    crews, sorties
        The aircraft; their flights, by aircraft and in flight order.
    dropped, left_out
        As ``Answer`` has them.
    assigned
        How good it is that these do this; None where nothing was assigned.
    """

    crews: tuple[Crew, ...]
    sorties: tuple[Sortie, ...]
    methods: dict[str, str]
    dropped: tuple[Finding, ...]
    left_out: tuple[LeftOut, ...]
    separation: Separation
    assigned: Assigned | None = None


def answer_of(crew: Crew, flown: Flown, left_out: tuple[LeftOut, ...] = ()) -> Answer:
    """A flight as the answer of one aircraft."""
    return Answer(
        crew.setting if flown.ends is None else replace(crew.setting, ends=flown.ends),
        flown.composed,
        flown.legs,
        flown.passes,
        flown.methods,
        (),
        flown.notes,
        left_out,
    )
