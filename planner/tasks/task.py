"""What a task is: a scenario in; legs, passes and what there is to say of them out."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

from planner.bounds.allowance import Allowance
from planner.errors import Finding
from planner.plan import LeftOut, Plan
from planner.profile.compose import Composed
from planner.progress import Progress, Stop, Until
from planner.publish import Leg
from planner.route import CollectPass
from planner.scenario import Scenario
from planner.tasks.setting import Setting

#: What the rules of findings about regions left out begin with.
NOT_SEEN = "not-seen-"


@dataclass(frozen=True, slots=True)
class Controls:
    """How a task is watched and stopped.

    Parameters
    ----------
    stop, enough
        The one cancels; the other ends the search for anything better.
    stage
        Takes the time of one stage, by name.
    """

    progress: Progress
    stop: Stop
    enough: Until
    stage: Callable[[str], AbstractContextManager[None]]


@dataclass(frozen=True, slots=True)
class Answer:
    """What one aircraft is to fly.

    Parameters
    ----------
    setting
        What the stages were told.
    composed
        The whole flight.
    legs, passes
        Names and methods of its legs, and its passes, in flight order.
    methods
        The algorithm of each stage that was used.
    dropped
        Why regions are left out, and what of others is not seen.
    notes
        Warnings besides.
    left_out
        Regions that need not be seen and are not.
    """

    setting: Setting
    composed: Composed
    legs: tuple[Leg, ...]
    passes: tuple[CollectPass, ...]
    methods: dict[str, str]
    dropped: tuple[Finding, ...]
    notes: tuple[str, ...]
    left_out: tuple[LeftOut, ...] = ()


@dataclass(frozen=True, slots=True)
class Task:
    """One question about a scenario.

    Parameters
    ----------
    answer
        Answers it, or raises InfeasibleError with the constraint, the feature and the nearest relaxation, or
        CancelledError once ``stop`` says so.
    bound_m
        A length that no plan over the regions a plan sees is under; what it takes to look for it is
        taken off what is allowed. None where the shortest is not what is looked for.
    """

    answer: Callable[[Scenario, Controls], Answer]
    bound_m: Callable[[Scenario, Plan, Stop, Allowance], float] | None
