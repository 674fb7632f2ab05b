"""How a plan is judged: what it costs and gives, what it leaves out, which constraints it does not keep."""

from __future__ import annotations

from dataclasses import dataclass, field

from planner.plan.seen import Surveyed
from planner.plan.words import LonLat


@dataclass(frozen=True, slots=True)
class Violation:
    """A constraint that the plan does not keep.

    Parameters
    ----------
    constraint
        ``turn-radius``, ``area``, ``hard-zone``, ``coverage``, ``collect-straight``, ``settling``,
        ``continuity``, ``range``, ``flight-time``, ``energy``, ``soft-threat``.
    feature
        The region, zone or vehicle concerned.
    where
        The worst place; None where there is none.
    amount, unit
        By how much.
    hard
        Whether a plan with it may be uploaded only with an explicit override.
    """

    constraint: str
    feature: str
    message: str
    amount: float
    unit: str
    where: LonLat | None = None
    hard: bool = True


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A region that need not be seen and is not.

    Parameters
    ----------
    reason
        ``range``, ``flight-time``, ``energy``, or what keeps every pass from seeing it: ``swath``, ``area`` …
    margin
        By how much a flight with it is over that limit, in m, s or Wh; None for other reasons.
    """

    roi: str
    reason: str
    margin: float | None = None


@dataclass(frozen=True, slots=True)
class VehicleMetrics:
    """What one of several aircraft does: all phases of all its sorties.

    Parameters
    ----------
    priority
        Collected: the sum over the regions that it sees, of those that others see too its share of visits.
    take_off_s, landing_s
        Of the first and of the last sortie, on the plan's clock.
    """

    length_m: float
    duration_s: float
    energy_wh: float | None
    priority: float
    sorties: int
    take_off_s: float
    landing_s: float


@dataclass(frozen=True, slots=True)
class Assigned:
    """How good the choice of who does what is, over the ways and times of travel that it was made by.

    Parameters
    ----------
    method, status
        ``assign`` or ``stecz2020``; ``optimal`` when proved best among them, else ``feasible``.
    objective_s
        Weighed last landing and time in the air, and what of the priority is left out.
    lower_bound_s, gap
        No assignment has less; by what part of the objective this one may be above the best. None unknown.
    """

    method: str
    status: str
    objective_s: float
    lower_bound_s: float | None
    gap: float | None


@dataclass(frozen=True, slots=True)
class Replanned:
    """What a plan made in flight is to the one before it.

    Parameters
    ----------
    begins_in_s
        From the call for it to its beginning: aircraft in flight have flown on by the old one until then.
    kept, moved, new
        Regions that the same aircraft sees in the same order as before; those that another does, or at
        another place of its order; those that were in no order.
    unless_better
        Another order is flown where it is better by this part.
    """

    begins_in_s: float
    kept: tuple[str, ...] = ()
    moved: tuple[str, ...] = ()
    new: tuple[str, ...] = ()
    unless_better: float | None = None


@dataclass(frozen=True, slots=True)
class Metrics:
    """What the plan costs and gives.

    ``length_m`` and ``duration_s`` are those of the mission phase, from where take-off and climbing turns end
    to where descending turns or the landing begin; ``flight_length_m``, ``flight_duration_s`` and
    ``energy_wh`` of all phases. ``route_length_m`` is the line over the ground from start to end, without
    turns flown for height; ``lower_bound_m`` what no mission phase over these regions is shorter than,
    threats left out, and ``gap`` by what part of its length this one is longer; None without a bound.
    Of a search ``area_seen_m2`` is the ground seen of what is searched, each place once, and
    ``importance_collected`` what that is worth where importance is given, of ``importance_total`` in all;
    no flight within the limits sees more than ``area_seen_bound_m2``, nor collects more than
    ``importance_bound``; None of other tasks, and of what drifts.
    ``photos`` counts those of all cameras, ``photos_mb`` is about what they take to be stored; None where
    there are none on board. ``surveys`` tells by region what they give. Of several aircraft or sorties all
    are sums; ``vehicles`` tells of each aircraft, ``last_landing_s`` when the last is down, ``assignment``
    how good it is; empty and None for one flight. ``replan`` tells of a plan made in flight; else None.
    """

    length_m: float
    collection_length_m: float
    duty_cycle: float
    path_length_ratio: float | None
    risk_missile: float
    risk_radar: float
    turns: int
    duration_s: float
    energy_wh: float | None
    coverage: dict[str, float]
    area_seen_m2: float | None = None
    importance_collected: float | None = None
    importance_total: float | None = None
    area_seen_bound_m2: float | None = None
    importance_bound: float | None = None
    planning_time_s: dict[str, float] = field(default_factory=dict)
    lower_bound_m: float | None = None
    gap: float | None = None
    flight_length_m: float | None = None
    flight_duration_s: float | None = None
    route_length_m: float | None = None
    left_out: tuple[LeftOut, ...] = ()
    photos: int | None = None
    photos_mb: float | None = None
    surveys: dict[str, Surveyed] = field(default_factory=dict)
    vehicles: dict[str, VehicleMetrics] = field(default_factory=dict)
    last_landing_s: float | None = None
    assignment: Assigned | None = None
    replan: Replanned | None = None
