"""Lines through soft threats where that costs less than going round.

The tangent connector keeps clear of soft discs as far as it can. Here a disc may be kept clear only in part:
a smaller disc about the same centre, whose radius is chosen by the cost of the whole line::

    length + RISK_M (wm ∫ kill ds + wr ∫ detection ds) / wl

with the risks of eqs 11 and 13 of Li, Chen, Wang, Li (2018), their sums of eqs 12 and 14 taken to the limit
of dividing points without distance, and the weights of eq 25. Hard zones stay what they are.

Discs are treated so where the weight of their risk is less than that of length, so that with equal weights a
way round is always taken where there is one, and where the line found crosses a disc anyway: one that holds
both ends, or that was given up for want of a way.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from planner.airspace import kernels
from planner.airspace.threats import threat_arrays
from planner.airspace.values import Threat
from planner.airspace.zone_kernels import distances_from
from planner.airspace.zones import TOUCH_M, KeepOut, pieces_of
from planner.dubins.path import Path
from planner.errors import InfeasibleError
from planner.progress import Stop, never, raise_if
from planner.route import Anchor
from planner.transit.tangent import connect
from planner.wishes import Objective

#: A metre at risk 1 costs as much as this many metres of way, where the weights are equal.
RISK_M = 20.0

#: Spacing of the sums that stand for the integrals.
SPACING_M = 5.0

#: Parts of a disc's radius that are tried, then halved steps round the best of them.
PARTS = (0.0, 0.25, 0.5, 0.75, 1.0)
HALVINGS = 3

#: Discs whose radius is chosen, the most expensive first, and rounds over all of them.
MOST_DISCS = 4
ROUNDS = 2

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Risk:
    """Soft threats at the flight altitude, and what their risk costs.

    Parameters
    ----------
    missiles, radars
        Arrays for the kernels, (K, 3) and (M, 4); see ``threat_arrays``.
    kill_m, detection_m
        Metres of way that a metre at risk 1 costs.
    names, yielding
        All of them, and those that may be crossed for the sake of length.
    """

    missiles: Array
    radars: Array
    kill_m: float
    detection_m: float
    names: frozenset[str]
    yielding: frozenset[str]

    @classmethod
    def of(cls, threats: Iterable[Threat], objective: Objective, altitude_m: float) -> Risk:
        """The risk of a scenario's soft threats."""
        soft = [t for t in threats if not t.hard and t.height_m >= altitude_m]
        weights = {"missile": objective.missile, "radar": objective.radar}
        # In proportion to each other, as far as one line and another go.
        length = objective.length + objective.energy
        cheap = [t.name for t in soft if weights[t.model] < length]
        per_metre = RISK_M / length if length > 0.0 else RISK_M
        missiles, radars = threat_arrays(soft, altitude_m)
        return cls(
            missiles,
            radars,
            per_metre * objective.missile,
            per_metre * objective.radar,
            frozenset(t.name for t in soft),
            frozenset(cheap),
        )

    def cost_m(self, path: Path) -> float:
        """Length and what the risk along it costs."""
        if len(self.missiles) == 0 and len(self.radars) == 0:
            return path.length_m
        points = path.sample(SPACING_M)[:, :2]
        kill, detection = kernels.curve_risk(points, self.missiles, self.radars, SPACING_M)
        return path.length_m + SPACING_M * (self.kill_m * kill + self.detection_m * detection)


def connect_by_cost(
    start: Anchor, goal: Anchor, zones: KeepOut, radius_m: float, risk: Risk, stop: Stop = never
) -> Path:
    """The line of ``tangent.connect``, through soft discs where the weights say so.

    Raises
    ------
    InfeasibleError, CancelledError
        As ``tangent.connect``.
    """
    path = connect(start, goal, zones, radius_m, stop)
    crossed = {c.zone for c in zones.conflicts(path)} & risk.names
    if not risk.yielding and not crossed:
        return path

    lines = _Lines(start, goal, zones, radius_m, stop)
    lines.keep(path, lines.radii({}))
    line = lines.line
    best, best_m, radii = path, risk.cost_m(path), {}
    direct = line(dict.fromkeys(risk.yielding, 0.0))
    if direct is not None:
        crossed |= {c.zone for c in zones.conflicts(direct)} & risk.yielding
        cost_m = risk.cost_m(direct)
        if cost_m < best_m - TOUCH_M:
            best, best_m, radii = direct, cost_m, dict.fromkeys(risk.yielding, 0.0)
    limits = {d.name: _largest_m(d.east_m, d.north_m, d.radius_m, start, goal) for d in zones.discs}
    chosen = sorted(crossed, key=lambda name: (-limits[name], name))[:MOST_DISCS]
    for _, name in itertools.product(range(ROUNDS), chosen):
        parts, step = list(PARTS), 0.5 * (PARTS[1] - PARTS[0])
        improved = False
        best_part = radii.get(name, limits[name]) / limits[name] if limits[name] > 0.0 else 0.0
        for _ in range(1 + HALVINGS):
            for part in parts:
                tried = {**radii, name: part * limits[name]}
                found = line(tried)
                cost_m = math.inf if found is None else risk.cost_m(found)
                if found is not None and cost_m < best_m - TOUCH_M:
                    best, best_m, radii, best_part, improved = found, cost_m, tried, part, True
            parts = [part for part in (best_part - step, best_part + step) if 0.0 <= part <= 1.0]
            step *= 0.5
            if not improved:
                break
    return best


@dataclass(slots=True)
class _Lines:
    """Lines between two ends past discs of other radii; what was found once serves where it must be again."""

    start: Anchor
    goal: Anchor
    zones: KeepOut
    radius_m: float
    stop: Stop
    _found: dict[tuple[float, ...], Path | None] = field(default_factory=dict)
    _clear: list[tuple[Array, Array, Path]] = field(default_factory=list)

    def radii(self, chosen: Mapping[str, float]) -> tuple[float, ...]:
        """Of all discs in turn."""
        return tuple(chosen.get(disc.name, disc.radius_m) for disc in self.zones.discs)

    def line(self, chosen: Mapping[str, float]) -> Path | None:
        """The connector's line where some discs have other radii; None where it finds none."""
        raise_if(self.stop)
        radii = self.radii(chosen)
        if radii not in self._found and not self._serves(radii):
            discs = tuple(replace(d, radius_m=r) for d, r in zip(self.zones.discs, radii, strict=True))
            zones = replace(self.zones, discs=discs)
            try:
                self.keep(connect(self.start, self.goal, zones, self.radius_m, self.stop), radii)
            except InfeasibleError:
                self._found[radii] = None
        return self._found[radii]

    def keep(self, path: Path, radii: tuple[float, ...]) -> None:
        """Remember the line found for some radii."""
        self._found[radii] = path
        self._clear.append((np.array(radii), distances_from(pieces_of(path), self.zones.disc_array()), path))

    def _serves(self, radii: tuple[float, ...]) -> bool:
        """Whether a line found past smaller discs, clear of them, is clear of these too: none is shorter."""
        wanted = np.array(radii)
        for fewer, away_m, path in self._clear:
            grown = wanted != fewer
            if (fewer <= wanted)[grown].all() and (wanted <= away_m + TOUCH_M)[grown].all():
                self._found[radii] = path
                return True
        return False


def _largest_m(east_m: float, north_m: float, radius_m: float, start: Anchor, goal: Anchor) -> float:
    """The largest disc about a centre, of no more than ``radius_m``, that holds neither end."""
    return min(radius_m, *(math.hypot(a.east_m - east_m, a.north_m - north_m) for a in (start, goal)))
