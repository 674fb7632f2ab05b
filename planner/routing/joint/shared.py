"""Passes shared by several regions, where the tour gets shorter.

Which items may be seen together their family knows. In a tour that has been found a group's passes are taken
out and one for all of it is put in where that costs least, what is left of groups divided by this is put in
again, and the best exchange is made as long as there is one. The tour over the groups is then chosen as any
other, and kept where it costs less; so is one of as few passes as there can be.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.ways import Group, Options, Sharing, Target
from planner.dubins.estimate_kernels import transit_costs
from planner.errors import InfeasibleError
from planner.progress import Stop, raise_if
from planner.route import CollectPass, Terminal
from planner.routing.joint.chain import from_start, to_end
from planner.routing.legs import Legs, leaves
from planner.vehicle.wind import still_air_costs

Floats = NDArray[np.float64]
Ends = tuple[Terminal, Terminal]

#: Headings and offsets of the passes tried for a group, and how many of them.
STEP_RAD = math.radians(2.5)
ETAS = np.array([0.0, 0.5, 1.0])
MOST_OPTIONS = 120
#: Exchanges, and groups tried again after one; an exchange has to save this much.
MOST_EXCHANGES, MOST_AGAIN, LEAST_GAIN_M = 40, 60, 1.0


@dataclass(frozen=True, slots=True, eq=False)
class _Stop:
    """A place in the tour: a group of items seen in one pass, or passes that are not to be exchanged."""

    items: Group
    entry: Floats
    exit: Floats
    inner_m: float


@dataclass(frozen=True, slots=True)
class Exchange:
    """A tour's targets, and which of them may share passes."""

    targets: tuple[Target, ...]
    sharing: Sharing
    ends: Ends
    around: Surroundings
    legs: Legs

    def shared(self, passes: Sequence[CollectPass], stop: Stop, enough: Stop) -> tuple[Target, ...] | None:
        """The targets with passes shared, by a tour that has been found; None where that saves nothing."""
        stops, groups = self._stops(passes), self.sharing.groups()
        if stops is None or not groups:
            return None
        options: dict[Group, Options | None] = {}
        changed = False
        for _ in range(MOST_EXCHANGES):
            known_m = self._tour_m(stops)
            here = {one.items for one in stops}
            tried: list[tuple[float, int, Group, list[_Stop]]] = []
            for group in groups:
                raise_if(stop)
                if enough():
                    break
                trial = None if group in here else self._exchanged(stops, group, options)
                if trial is not None:
                    tried.append((self._tour_m(trial), len(tried), group, trial))
            if not tried or min(tried)[0] >= known_m - LEAST_GAIN_M:
                break
            stops, changed = min(tried)[3], True
            # What gains most in one tour does so in the next.
            groups = [group for _, _, group, _ in sorted(tried)[:MOST_AGAIN]]
        return self._grouped([one.items for one in stops if one.items]) if changed else None

    def fewest(self) -> tuple[Target, ...] | None:
        """The targets with as few passes as taking the largest groups first gives; None where none share."""
        rest = frozenset(range(len(self.sharing.owners)))
        chosen: list[Group] = []
        groups = self.sharing.groups()
        while rest and groups:
            group = max((group & rest for group in groups), key=lambda each: (len(each), sorted(each)))
            if len(group) < 2:
                break
            chosen.append(group)
            rest -= group
        return self._grouped([*chosen, *(frozenset([k]) for k in sorted(rest))]) if chosen else None

    def _grouped(self, groups: Sequence[Group]) -> tuple[Target, ...] | None:
        """Targets for groups; as they were those without items, and those that are a group by themselves."""
        owners = self.sharing.owners
        found = [target for k, target in enumerate(self.targets) if k not in owners]
        for group in sorted(groups, key=min):
            own = self._own(group)
            target = self.targets[own] if own is not None else self.sharing.target(group)
            if target is None:
                return None
            found.append(target)
        return tuple(found)

    def _own(self, group: Group) -> int | None:
        """The target that a group is all items of."""
        owner = self.sharing.owners[min(group)]
        return owner if group == {k for k, of in enumerate(self.sharing.owners) if of == owner} else None

    def _stops(self, passes: Sequence[CollectPass]) -> list[_Stop] | None:
        """A tour's places; None where a target's passes cannot be told from others'."""
        owners = self.sharing.owners
        waiting = {owner: frozenset(k for k, of in enumerate(owners) if of == owner) for owner in owners}
        stops = []
        for collect in passes:
            # Parts of one region share its name: the pass's own is the nearest.
            middle = collect.footprint.centroid
            own = [k for k in waiting if self.targets[k].region.names == collect.regions]
            nearest = min(
                own, key=lambda k: shapely.distance(self.targets[k].region.area, middle), default=None
            )
            items = frozenset[int]() if nearest is None else waiting.pop(nearest)
            start, end = self.legs.arrives(collect), leaves(collect)
            entry = np.array([*start.position, collect.angle_rad])
            exit_ = np.array([*end.position, collect.angle_rad])
            stops.append(_Stop(items, entry, exit_, self.legs.pass_m(collect)))
        return None if waiting else stops

    def _options(self, group: Group) -> Options | None:
        """Passes for a group to be put in; None where there are none."""
        own = self._own(group)
        target = self.targets[own] if own is not None else self.sharing.target(group)
        if target is None:
            return None
        try:
            found = target.coarse(STEP_RAD, ETAS)
        except InfeasibleError:
            return None
        if len(found.inner_m) <= MOST_OPTIONS:
            return found
        return found.rows(np.unique(np.linspace(0, len(found.inner_m) - 1, MOST_OPTIONS).astype(np.int64)))

    def _exchanged(
        self, stops: list[_Stop], group: Group, options: dict[Group, Options | None]
    ) -> list[_Stop] | None:
        """The tour with one pass for a group, and what is left of groups that it takes from put in again."""
        touched = [one for one in stops if one.items & group]
        trial = [one for one in stops if not one.items & group]
        for wanted in (group, *(one.items - group for one in touched)):
            if not wanted:
                continue
            if wanted not in options:
                options[wanted] = self._options(wanted)
            found = options[wanted]
            if found is None:
                return None
            trial = self._inserted(trial, wanted, found)
        return trial

    def _inserted(self, stops: list[_Stop], items: Group, options: Options) -> list[_Stop]:
        """The tour with a pass put in where it costs least."""
        into = [from_start(self.ends[0], self.around, options.entries, self.around.discs)]
        out = [to_end(self.ends[1], self.around, options.exits, self.around.discs)]
        if stops:
            into += list(self._costs(np.stack([one.exit for one in stops]), options.entries))
            out = [*self._costs(options.exits, np.stack([one.entry for one in stops])).T, *out]
        cost_m = np.stack(into) + np.stack(out) + options.inner_m[None, :] - self._legs(stops)[:, None]
        at, row = (int(k) for k in np.unravel_index(int(np.argmin(cost_m)), cost_m.shape))
        new = _Stop(items, options.entries[row], options.exits[row], float(options.inner_m[row]))
        return [*stops[:at], new, *stops[at:]]

    def _legs(self, stops: list[_Stop]) -> Floats:
        """From the start through all places to the end: each leg."""
        start, end = self.ends
        if not stops:
            return np.array([math.dist(start.position, end.position)])
        exits, entries = np.stack([one.exit for one in stops]), np.stack([one.entry for one in stops])
        first = from_start(start, self.around, entries[:1], self.around.discs)
        between = [
            self._costs(one[None], other[None])[0] for one, other in zip(exits[:-1], entries[1:], strict=True)
        ]
        return np.concatenate([first, *between, to_end(end, self.around, exits[-1:], self.around.discs)])

    def _costs(self, exits: Floats, entries: Floats) -> Floats:
        around = self.around
        costs_m = transit_costs(exits, entries, around.radius_m, around.discs)
        return still_air_costs(costs_m, exits[:, None], entries[None], around.airspeed_m_s, around.wind)

    def _tour_m(self, stops: list[_Stop]) -> float:
        return float(self._legs(stops).sum()) + math.fsum(one.inner_m for one in stops)
