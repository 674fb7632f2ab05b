"""Lines that find a target most likely and soonest, for one aircraft or several.

Anytime: the standard patterns are flown in many shapes (spacing, course, size, along with the drift), the
best of them varied and kept, then changed corner by corner; then the line of one aircraft after the other is
planned anew by a beam search over lines of bounded curvature, from some place along it on, the others' looks
taken off, and kept where the whole gets better. What counts is how likely the target is found on average
over the flight, and that no standard pattern is ahead at any quarter of it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.search.belief.indexed import Indexed, Running, flown_by
from planner.search.belief.kernels import beam_line
from planner.search.belief.legs import improve, reached
from planner.search.belief.lines import homeward
from planner.search.belief.patterns import LEGGED, PATTERNS, Searcher, Shape, pattern_corners, pattern_lines
from planner.search.belief.success import missed, success
from planner.search.belief.target import Belief, Target

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Lines = list[Floats]

#: Places that the plan is judged by, and that lines are searched by.
PLACES, SEARCHED = 16_384, 256
#: Edges of what is seen are so wide for them, in distances between places where they lie closest.
SOFT = 0.5
#: Times at which success is looked at, and quarters among them.
TIMES = 24
#: Shapes that each pattern is tried in.
SPACINGS, COURSES, SIZES = (0.8, 1.0, 1.25), 4, (0.7, 1.0)
WIDTH = 16
#: From, to: pull of what lies about, the distance at which it pulls half in swaths, what being early counts.
MANNERS = ((0.03, 1.0), (1.0, 8.0), (0.02, 2.0))
#: Changes of corners, of each start and of the best; then lines planned anew.
FIRST, LEGS, ROUNDS = 600, 3_000, 15
#: Shapes that are varied, how often.
SHAPES, LAST, VARIED = 3, 2, 40
#: A standard pattern is behind by this margin at each quarter, or that counts so much.
MARGIN, BEHIND = 0.012, 8.0


@dataclass(frozen=True, slots=True, eq=False)
class Map:
    """What is not free: bool (rows, columns) from a south-west corner; an empty one blocks nothing."""

    blocked: Bools
    west_m: float = 0.0
    south_m: float = 0.0
    cell_m: float = 1.0

    @classmethod
    def open(cls) -> Map:
        """Nothing in the way."""
        return cls(np.zeros((0, 0), dtype=np.bool_))

    def clear(self, line: Floats) -> bool:
        """Whether all of a line's samples are free."""
        if not self.blocked.size:
            return True
        row = np.floor((line[:, 1] - self.south_m) / self.cell_m).astype(np.int64)
        column = np.floor((line[:, 0] - self.west_m) / self.cell_m).astype(np.int64)
        inside = (row >= 0) & (column >= 0) & (row < self.blocked.shape[0]) & (column < self.blocked.shape[1])
        return bool(inside.all() and not self.blocked[row, column].any())


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """Lines, one an aircraft, and how likely the target is found by ``times_s``, as believed in planning."""

    lines: tuple[Floats, ...]
    times_s: Floats
    success: Floats


def auto(
    target: Target,
    searchers: tuple[Searcher, ...],
    *,
    free: Map | None = None,
    seed: int = 0,
    enough: Callable[[], bool] = lambda: False,
) -> Found:
    """Plan the lines of all aircraft.

    Parameters
    ----------
    free
        Where lines may lead.
    seed
        Of the places that stand for what is believed.
    enough
        Asked between steps: ends the search with the best found.
    """
    return _Search(target, searchers, free or Map.open(), seed, enough).found()


@dataclass(frozen=True, slots=True, eq=False)
class _Tried:
    """A pattern in a shape, its corners and their lines' value."""

    value: float
    last: float
    name: str
    shape: Shape
    corners: list[Floats]


class _Search:
    """One search's fixed values, and the best so far."""

    def __init__(
        self,
        target: Target,
        searchers: tuple[Searcher, ...],
        free: Map,
        seed: int,
        enough: Callable[[], bool],
    ) -> None:
        self._target, self._searchers, self._free, self._enough = target, searchers, free, enough
        self._seed, self._some = seed, False
        self._block = np.random.default_rng(seed + 1)
        self._belief = Belief.drawn(target, PLACES, seed)
        until_s = max(one.until_s for one in searchers)
        self._times = until_s * np.arange(1, TIMES + 1) / TIMES
        apart_m = math.sqrt(math.tau / PLACES) * target.error_m(0.5 * until_s)
        half_m = min(one.half_width_m for one in searchers)
        self._indexed = Indexed.of(self._belief, self._times, half_m, min(SOFT * apart_m, half_m))
        self._quarters = np.arange(TIMES // 4 - 1, TIMES, TIMES // 4)
        drift = target.drift_m_s
        self._course = math.atan2(drift[1], drift[0]) - 0.5 * math.pi
        standard = [
            lines
            for name in PATTERNS
            if self._clear(lines := pattern_lines(name, target, searchers, Shape(course_rad=self._course)))
        ]
        # Legs that touch lose by soft edges, and the manuals' do: what they find is reckoned without.
        sharp = replace(self._indexed, soft_m=0.0)
        self._ahead = np.max(
            [sharp.success(lines, searchers)[self._quarters] for lines in standard], axis=0, initial=0.0
        )

    def found(self) -> Found:
        generator = np.random.default_rng(self._seed)
        starts = [(self._running(self._flown(corners)), corners) for corners in self._shaped()]
        for running, corners in starts:
            self._legs(running, corners, FIRST, generator)
        if starts:
            best, corners = max(starts, key=lambda one: one[0].value)
            self._legs(best, corners, LEGS, generator)
        else:
            best = self._running(self._from_nothing())
        self._improve(best, ROUNDS, generator)
        lines = best.lines
        return Found(tuple(lines), self._times, success(lines, self._searchers, self._belief, self._times))

    def _running(self, lines: Lines) -> Running:
        return Running(self._indexed, self._searchers, self._worth, lines)

    def _flown(self, corners: list[Floats]) -> Lines:
        return [flown_by(each, one) for each, one in zip(corners, self._searchers, strict=True)]

    def _legs(
        self, running: Running, corners: list[Floats], tries: int, generator: np.random.Generator
    ) -> None:
        """Corner by corner."""
        improve(running, corners, self._searchers, self._free.clear, tries, generator, self._enough)

    def _from_nothing(self) -> Lines:
        """Lines where no pattern may be flown: one after the other."""
        lines: Lines = []
        for index in range(len(self._searchers)):
            lines.append(self._again(lines, index, 0.0, (0.3, 3.0, 1.0)))
        return lines

    def _improve(self, running: Running, rounds: int, generator: np.random.Generator) -> None:
        """Lines planned anew, one at a time from some part of its flight on, where the whole gets better."""
        for _ in range(rounds):
            if self._enough():
                return
            index = int(generator.integers(len(running.lines)))
            part = float(max(0.0, generator.uniform(-0.2, 0.9)))
            manner = tuple(np.exp(generator.uniform(*np.log(MANNERS).T)).tolist())
            line = self._again(running.lines, index, part, manner)
            if self._free.clear(line):
                running.better(index, line, 1e-6)

    def _success(self, lines: Lines) -> Floats:
        return self._indexed.success(lines, self._searchers)

    def _worth(self, by_time: Floats) -> float:
        margins = by_time[self._quarters] - self._ahead
        return float(by_time.mean() + BEHIND * np.minimum(margins - MARGIN, 0.0).sum())

    def _clear(self, lines: Lines) -> bool:
        return all(self._free.clear(line) for line in lines)

    def _shaped(self) -> list[list[Floats]]:
        """Corners of the best of the patterns in many shapes, each then varied."""
        tried = [one for name, shape in self._shapes() if (one := self._tried(name, shape))]
        tried.sort(key=lambda one: -one.value)
        kept = tried[:SHAPES]
        # What finds most in the end is a start, too.
        kept += sorted(tried[SHAPES:], key=lambda one: -one.last)[:LAST]
        generator = np.random.default_rng(self._seed)
        for index, one in enumerate(kept):
            best = one
            for _ in range(VARIED):
                if self._enough():
                    break
                other = self._tried(best.name, best.shape.varied(generator))
                if other and other.value > best.value:
                    best = other
            kept[index] = best
        kept.sort(key=lambda one: -one.value)
        return [one.corners for one in kept]

    def _tried(self, name: str, shape: Shape) -> _Tried | None:
        """One pattern flown; None where something is in the way, or there is no time left to try it."""
        if self._some and self._enough():
            return None
        drawn = pattern_corners(name, self._target, self._searchers, shape)
        corners = [reached(each, one) for each, one in zip(drawn, self._searchers, strict=True)]
        lines = self._flown(corners)
        if not self._clear(lines):
            return None
        self._some = True
        by_time = self._success(lines)
        return _Tried(self._worth(by_time), float(by_time[-1]), name, shape, corners)

    def _shapes(self) -> Iterator[tuple[str, Shape]]:
        plain = Shape(course_rad=self._course)
        for name in PATTERNS:
            yield name, plain
        for name, spacing, drifting, size in itertools.product(PATTERNS, SPACINGS, (False, True), SIZES):
            for k, outward in itertools.product(range(COURSES), (False, True)):
                if outward and name not in LEGGED:
                    continue
                course = self._course + math.tau * k / COURSES
                yield (
                    name,
                    replace(
                        plain,
                        spacing=spacing,
                        drifting=drifting,
                        size=size,
                        course_rad=course,
                        outward=outward,
                    ),
                )

    def _again(self, lines: Lines, index: int, part: float, manner: tuple[float, ...]) -> Floats:
        """An aircraft's line planned anew from a part of its flight on, what the others see taken off."""
        others = [k for k in range(len(lines)) if k != index]
        known = [lines[k] for k in others]
        searchers = [self._searchers[k] for k in others]
        # A line fits the places that it is searched by: others each time.
        first = SEARCHED * int(self._block.integers(max(1, PLACES // SEARCHED)))
        whole, some = self._belief, slice(first, first + SEARCHED)
        belief = Belief(whole.places_m[some], whole.drifts_m_s[some], whole.weights[some])
        left = missed(known, searchers, belief, self._times[-1:])[0]
        line = lines[index] if index < len(lines) else None
        return self._line(self._searchers[index], line, part, belief, left, manner)

    def _line(
        self,
        one: Searcher,
        line: Floats | None,
        part: float,
        belief: Belief,
        left: Floats,
        manner: tuple[float, ...],
    ) -> Floats:
        pull, reach, hurry = manner
        start_s, kept = 0.0, np.zeros((0, 3))
        if line is not None and part > 0.0:
            count = int(np.searchsorted(line[:, 2], part * one.until_s))
            kept = line[: max(2, min(count, len(line) - 1))]
        if len(kept) >= 2:
            begin, here = kept[-2], kept[-1]
            pose = np.array([here[0], here[1], math.atan2(here[1] - begin[1], here[0] - begin[0])])
            start_s = float(here[2])
            seen = missed([kept], [one], belief, self._times[-1:])[0]
            left = left * seen
        else:
            datum = self._target.datum_m(0.0)
            away = math.atan2(datum[1] - one.base_m[1], datum[0] - one.base_m[0])
            pose = np.array([*one.base_m, away])
        weights = belief.weights * left
        poses, _ = beam_line(
            pose,
            start_s,
            np.asarray(one.base_m),
            np.ascontiguousarray(belief.places_m),
            np.ascontiguousarray(belief.drifts_m_s),
            np.ascontiguousarray(weights / max(weights.sum(), 1e-300)),
            one.half_width_m,
            1.0 - one.detection,
            one.speed_m_s,
            one.turn_radius_m,
            max(one.turn_radius_m, 0.7 * one.half_width_m),
            2,
            one.until_s,
            WIDTH,
            pull,
            reach * 2.0 * one.half_width_m,
            hurry,
            self._free.blocked,
            np.array([self._free.west_m, self._free.south_m, self._free.cell_m]),
        )
        drawn = np.concatenate([kept[:-1], poses[:, [0, 1, 3]]]) if len(kept) else poses[:, [0, 1, 3]]
        return homeward(drawn, one.base_m, one.speed_m_s, one.turn_radius_m, one.until_s)
