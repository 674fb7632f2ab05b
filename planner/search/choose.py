"""The search patterns of a ground laid, cut to a budget, and ranked by what they are worth."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter
from shapely.geometry import MultiPolygon, Point, Polygon, box
from shapely.ops import nearest_points

from planner.progress import Stop, never, raise_if
from planner.route import Look
from planner.search.belief.drifting import Drifting
from planner.search.belief.strips import drifting_strips
from planner.search.families import FAMILIES, patterns
from planner.search.horizon import VARIANTS
from planner.search.importance.strips import WALKS, walked
from planner.search.programme import Place, Pricing, Programme, Sweep, cut_to, seen_worth, thinned_to
from planner.search.room import LEAST_PASS_M, Room
from planner.search.shifted import moves, shifted, strip_of
from planner.search.straights import horizon_strips
from planner.search.swaths import Looking
from planner.search.values import Worth

Floats = NDArray[np.float64]

#: Headings at which lanes are laid.
HEADINGS_RAD = np.radians(np.arange(0.0, 180.0, 22.5))
#: Patterns are thinned out, too, where they have no more passes than this.
MOST_THINNED = 60
#: So many of the patterns that see most are thinned out.
MOST_PATTERNS_THINNED = 16
#: So many of the best are refined, by steps of these parts of a swath, for more than this part.
MOST_REFINED, STEPS, LEAST_GAIN = 4, (0.5, 0.25, 0.12), 1e-4
#: So many parts, the largest, are searched of what is worth most.
MOST_PARTS = 12
#: Ground larger than this many times what the budget sees is searched in part.
LARGER = 1.3
#: Passes made as long as need be are longer by this.
ROUNDING_M = 1e-6
#: Patterns that take less than this part of the budget are flown again, so often at most.
ROOM_AGAIN, MOST_AGAIN = 0.97, 6
#: What programmes are called whose strips were moved each by itself.
REFINED = "refined"
#: Published methods, flown as published.
PUBLISHED = ("snyder2021", *VARIANTS)
#: Where nothing else is within a budget so many flights by one pass are tried.
NEAREST = 3
#: Where their first passes find nothing, so many patterns are looked through.
LOOKED_THROUGH = 16
#: Less than this part of all that can be found is nothing.
NOTHING = 1e-7
#: Strips by the width of the swath: wider ones leave gaps, and reach farther.
WIDTHS = (1.0, 1.08)


@dataclass(frozen=True, slots=True, eq=False)
class Laid:
    """A pattern's passes, and the strips and the side looked to that they are made of."""

    family: str
    whole: tuple[Sweep, ...]
    strips: Floats
    look: Look


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """One search as the choice sees it; of one family alone where that is named.

    ``kept`` are passes of a plan that is being flown, lines and the sides looked to.
    """

    ground: Polygon | MultiPolygon
    worth: Worth
    looking: Looking
    room: Room
    pricing: Pricing
    stop: Stop = never
    enough: Stop = never
    family: str | None = None
    detection: float = 1.0
    drifting: Drifting | None = None
    seed: int = 0
    kept: tuple[tuple[Place, Place, Look], ...] = ()

    @property
    def total(self) -> float:
        """All that can be found."""
        return self.worth.total if self.drifting is None else self.drifting.total

    def finds(self, worth: float) -> bool:
        """Whether that is anything of what is looked for."""
        return worth > NOTHING * self.total

    def found(self, sweeps: Sequence[Sweep]) -> float:
        """What passes find: of the worth of ground, or of what drifts, the sooner the better."""
        if self.drifting is not None:
            return self.drifting.found(sweeps, self.pricing)
        return seen_worth(sweeps, self.worth, self.detection)

    def ranked(self, budget_m: float, *, refined: bool = True) -> list[Programme]:
        """Programmes within a budget, metres through the air: those worth most, refined if asked, as laid."""
        found: list[Programme] = []
        width_m = self.looking.narrowest_m()
        of_grounds = (each for part in self._grounds(budget_m, width_m) for each in self._laid(part, width_m))
        laid_besides = (self._walked, self._published, self._drifted)
        of_others = (each for lay in laid_besides for each in lay(budget_m, width_m))
        for laid in itertools.chain(of_grounds, of_others):
            found += self._cut(laid, budget_m, thin=False)
            if self._over(found):
                break
        for each in tuple(found):
            if self._over(found):
                break
            found += self._again(each, budget_m)
        found.sort(key=lambda each: (-each.worth, each.cost_m))
        thinned = [
            way
            for each in found[:MOST_PATTERNS_THINNED]
            if each.family not in PUBLISHED and not self._over(found)
            for way in self._cut(each, budget_m, thin=True)
        ]
        ways = sorted(found + thinned, key=lambda each: (-each.worth, each.cost_m))
        best = ways[:MOST_REFINED] if refined else []
        improved = [
            self._refined(way, budget_m, width_m)
            for way in best
            if way.family not in WALKS and way.family not in VARIANTS and not self._over(found)
        ]
        improved.sort(key=lambda each: (-each.worth, each.cost_m))
        # What is estimated to be better may take more when it is flown: both are offered in turn.
        pairs = [each for pair in zip(improved, ways, strict=False) for each in pair]
        return [*self.going_on(), *pairs, *ways[len(improved) :]]

    def going_on(self) -> tuple[Programme, ...]:
        """What was still to be flown by a plan that is being flown, where it may be flown now: all of it."""
        sweeps: list[Sweep] = []
        for start, end, look in self.kept:
            swath = self.looking.swath(math.atan2(end[1] - start[1], end[0] - start[0]), look)
            least_m = max(0.0, swath.run_in_m + swath.run_out_m) + LEAST_PASS_M
            (ways,) = self.room.flyable(np.array([[start, end]]))
            sweeps += [Sweep(*way, look, swath) for way in ways if math.dist(*way) >= least_m]
        if not sweeps:
            return ()
        strips = np.array([strip_of(sweep) for sweep in sweeps])
        laid = Laid(self.family or REFINED, tuple(sweeps), strips, sweeps[0].look)
        return self._cut(laid, math.inf, thin=False)

    def _over(self, found: Sequence[Programme]) -> bool:
        """Whether what has been found is to do, asked between steps."""
        raise_if(self.stop)
        return bool(found) and self.enough()

    def recut(self, programme: Programme, budget_m: float) -> Programme | None:
        """The same pattern within another budget; None where nothing of it fits."""
        return next(iter(self._cut(programme, budget_m, thin=programme.thinned)), None)

    def _refined(self, best: Programme, budget_m: float, width_m: float) -> Programme:
        """Its strips turned, moved and stretched for as long as more is seen, by less and less."""
        for part in STEPS:
            moved = True
            while moved:
                moved = False
                for strips in moves(best.strips, part, width_m):
                    if self._over((best,)):
                        return best
                    sweeps = tuple(self.sweeps_over(strips, best.look))
                    if not sweeps:
                        continue
                    laid = Laid(best.family, sweeps, strips, best.look)
                    for way in self._cut(laid, budget_m, thin=best.thinned):
                        if way.worth > best.worth * (1.0 + LEAST_GAIN):
                            best, moved = way, True
        return best

    def shifted(self, start: Programme, budget_m: float) -> Programme:
        """The strips of a programme moved each by itself, for more within a budget."""
        known: dict[bytes, tuple[Sweep, ...]] = {}

        def tried(strips: Floats) -> Programme | None:
            raise_if(self.stop)
            sweeps: list[Sweep] = []
            for strip in strips:
                key = strip.tobytes()
                if key not in known:
                    known[key] = tuple(self.sweeps_over(strip[None], start.look))
                sweeps += known[key]
            laid = Laid(REFINED, tuple(sweeps), strips, start.look)
            return next(iter(self._cut(laid, budget_m, thin=False)), None)

        laid = np.array([strip_of(sweep) for sweep in start.sweeps])
        return shifted(laid, tried, self.looking.narrowest_m(), self.total, self.seed, self.enough) or start

    def _again(self, way: Programme, budget_m: float) -> Iterator[Programme]:
        """A pattern to and fro for as long as the budget lasts, where looks again find something."""
        if self.detection >= 1.0 or way.cost_m > ROOM_AGAIN * budget_m or not way.whole:
            return
        back = tuple(self.sweeps_over(way.strips[::-1, ::-1], way.look))
        sweeps, strips = way.whole, way.strips
        rounds = min(MOST_AGAIN, math.ceil(budget_m / max(way.cost_m, 1.0)))
        for number in range(rounds):
            sweeps += way.whole if number % 2 else back
            strips = np.concatenate([strips, way.strips if number % 2 else way.strips[::-1, ::-1]])
        yield from self._cut(Laid(way.family, sweeps, strips, way.look), budget_m, thin=False)

    def flyable(self) -> Iterator[tuple[Sweep, ...]]:
        """Passes over the ground, by pattern, whatever they cost; none where it is blocked."""
        of_all = self if self.family in FAMILIES else replace(self, family=None)
        laid = of_all._laid(self.ground, self.looking.narrowest_m(), (1.0,))
        return (each.whole for each in laid)

    def nearest(self) -> list[Programme]:
        """Patterns cut to one pass, whatever that costs: the nearest of those that find something.

        The first pass; where no first one finds anything the nearest that does, of a few patterns.
        """
        of_all = self if self.family in FAMILIES else replace(self, family=None)
        laid = tuple(of_all._laid(self.ground, self.looking.narrowest_m(), (1.0,)))
        firsts = [self._alone_of(each, each.whole[:1]) for each in laid]
        found = [each for each in firsts if self.finds(each.worth)]
        for each in () if found else laid[:LOOKED_THROUGH]:
            ways = [self._alone_of(each, (sweep,)) for sweep in each.whole]
            found += [way for way in ways if self.finds(way.worth)]
        return sorted(found or firsts, key=lambda each: each.cost_m)[:NEAREST]

    def _alone_of(self, laid: Laid, way: tuple[Sweep, ...]) -> Programme:
        """One pass of a pattern."""
        worth, cost_m = self.found(way), self.pricing.cost_m(way)
        return Programme(laid.family, way, worth, cost_m, laid.whole, False, laid.strips, laid.look)

    def _cut(self, laid: Laid | Programme, budget_m: float, *, thin: bool) -> tuple[Programme, ...]:
        """A pattern within a budget: its first passes, or those worth most; none where no pass fits."""
        whole = laid.whole
        if not thin:
            way = cut_to(whole, self.pricing, budget_m)
        elif 1 < len(whole) <= MOST_THINNED:
            way = thinned_to(whole, self.pricing, budget_m, self._alone(whole))
        else:
            return ()
        if not way:
            return ()
        worth, cost_m = self.found(way), self.pricing.cost_m(way)
        return (Programme(laid.family, way, worth, cost_m, whole, thin, laid.strips, laid.look),)

    def _alone(self, sweeps: Sequence[Sweep]) -> Floats:
        """What each pass finds, as if there were no other."""
        if self.drifting is not None:
            return self.drifting.alone(sweeps, self.pricing)
        return np.array([seen_worth([sweep], self.worth, self.detection) for sweep in sweeps])

    def _laid(
        self, ground: Polygon | MultiPolygon, width_m: float, widths: Sequence[float] = WIDTHS
    ) -> Iterator[Laid]:
        """Every pattern as passes that may be flown."""
        datum = self._datum()
        for part in widths:
            for pattern in patterns(ground, part * width_m, HEADINGS_RAD, datum):
                if self.family not in (None, REFINED, pattern.family):
                    continue
                for look in self.looking.looks:
                    sweeps = tuple(self.sweeps_over(pattern.strips, look))
                    if sweeps:
                        yield Laid(pattern.family, sweeps, pattern.strips, look)

    def _walked(self, budget_m: float, width_m: float) -> Iterator[Laid]:
        """Walks over cells of importance; where all ground is worth the same, only if asked for by name."""
        scores = self.worth.scores[self.worth.scores > 0.0]
        plain = not len(scores) or scores.min() > 0.999 * scores.max()
        if self.family is None and (plain or self.drifting is not None):
            return
        name = "importance" if self.family is None else self.family
        if name not in WALKS:
            return
        ends = (self.pricing.start, self.pricing.end)
        for strips in walked(name, self.worth, width_m, self.room.free, ends, budget_m, self.enough):
            raise_if(self.stop)
            for look in self.looking.looks:
                sweeps = tuple(self.sweeps_over(strips, look))
                if sweeps:
                    yield Laid(name, sweeps, strips, look)

    def _published(self, budget_m: float, width_m: float) -> Iterator[Laid]:
        """The published receding horizon, asked for by name."""
        if self.family not in VARIANTS:
            return
        strips = horizon_strips(self.family, self.ground, self.worth, width_m, self.pricing, budget_m)
        for look in self.looking.looks:
            sweeps = tuple(self.sweeps_over(strips, look)) if len(strips) else ()
            if sweeps:
                yield Laid(self.family, sweeps, strips, look)

    def _drifted(self, budget_m: float, width_m: float) -> Iterator[Laid]:
        """Patterns about what drifts, and lines planned for where it may be."""
        if self.drifting is None or self.family not in (None, REFINED):
            return
        for name, strips in drifting_strips(self.drifting, self.pricing, width_m, budget_m, self.seed):
            raise_if(self.stop)
            for look in self.looking.looks:
                sweeps = tuple(self.sweeps_over(strips, look)) if len(strips) else ()
                if sweeps:
                    yield Laid(name, sweeps, strips, look)

    def sweeps_over(self, strips: Floats, look: Look) -> Iterator[Sweep]:
        """The passes that see strips, looking to one side, where they may be flown."""
        along = strips[:, 1] - strips[:, 0]
        lengths_m = np.hypot(*along.T)
        along = along / np.maximum(lengths_m, 1e-9)[:, None]
        courses = [round(math.atan2(north, east), 9) for east, north in along.tolist()]
        known = {course: self.looking.swath(course, look) for course in set(courses)}
        swaths = [known[course] for course in courses]
        middles_m, ins_m, outs_m = np.array([(s.middle_m, s.run_in_m, s.run_out_m) for s in swaths]).T[
            :, :, None
        ]
        aside = -middles_m * np.stack([-along[:, 1], along[:, 0]], axis=1)
        lines = np.stack(
            [strips[:, 0] + aside - ins_m * along, strips[:, 1] + aside + outs_m * along], axis=1
        )
        least_m = np.maximum(0.0, ins_m + outs_m)[:, 0] + LEAST_PASS_M
        short_m = least_m - lengths_m - (ins_m + outs_m)[:, 0]
        if len(strips) and short_m.min() > 0.0:
            # Ground shorter than a frame is seen by the shortest pass over its middle.
            longer = (0.5 * short_m[:, None] + ROUNDING_M) * along
            lines = lines + np.stack([-longer, longer], axis=1)
            lengths_m = lengths_m + short_m + 2.0 * ROUNDING_M
        long = np.flatnonzero(lengths_m + (ins_m + outs_m)[:, 0] >= least_m)
        for k, ways in zip(long.tolist(), self.room.flyable(lines[long]), strict=True):
            for begin, until in ways:
                sweep = Sweep(begin, until, look, swaths[k])
                if sweep.length_m >= least_m[k]:
                    yield sweep

    def _grounds(self, budget_m: float, width_m: float) -> Sequence[Polygon | MultiPolygon]:
        """The ground whole, or parts of it where that is far more than can be seen."""
        seen_m2 = budget_m * width_m
        if not math.isfinite(seen_m2) or self.ground.area <= LARGER * seen_m2:
            return (self.ground,)
        half_m = 0.5 * math.sqrt(seen_m2)
        found: list[Polygon | MultiPolygon] = []
        for east_m, north_m in {self._richest(2.0 * half_m), self._nearest(half_m), self._datum()}:
            window = box(east_m - half_m, north_m - half_m, east_m + half_m, north_m + half_m)
            part = self.ground.intersection(window)
            if isinstance(part, Polygon | MultiPolygon) and not part.is_empty:
                found.append(part)
        return (*found, *self._rich(seen_m2)) or (self.ground,)

    def _rich(self, seen_m2: float) -> list[Polygon | MultiPolygon]:
        """What is worth most of the ground, as far as can be seen, and to the next lower score."""
        cell_m = self.worth.cell_m
        # Steps of a hundredth: noise is no reason to search here and not beside.
        scores = np.round(100.0 * self.worth.scores / max(float(self.worth.scores.max()), 1e-300))
        levels, counts = np.unique(scores[scores > 0.0], return_counts=True)
        if len(levels) < 2:
            return []
        areas_m2 = counts[::-1].cumsum() * cell_m**2
        held = int(np.searchsorted(areas_m2, seen_m2, side="right"))
        least_m2 = self.looking.narrowest_m() ** 2
        found: list[Polygon | MultiPolygon] = []
        for taken in {max(held, 1), held + 1}:
            if taken >= len(levels):
                continue
            rows, columns = np.nonzero(scores >= levels[::-1][taken - 1])
            west_m, south_m = self.worth.west_m + columns * cell_m, self.worth.south_m + rows * cell_m
            cells = shapely.box(west_m, south_m, west_m + cell_m, south_m + cell_m)
            parts = shapely.get_parts(shapely.union_all(cells).simplify(cell_m))
            large = sorted((part for part in parts if part.area > least_m2), key=shapely.area)
            if large:
                found.append(MultiPolygon(large[-MOST_PARTS:]))
        return found

    def _datum(self) -> tuple[float, float]:
        """The middle of what the ground is worth."""
        scores, centres_m = self.worth.scores, self.worth.centres_m
        if scores.sum() <= 0.0:
            middle = self.ground.representative_point()
            return (middle.x, middle.y)
        at = (scores[..., None] * centres_m).sum(axis=(0, 1)) / scores.sum()
        return (float(at[0]), float(at[1]))

    def _richest(self, side_m: float) -> tuple[float, float]:
        """Middle of the square of a side that is worth most."""
        cells = max(1, round(side_m / self.worth.cell_m))
        within = uniform_filter(self.worth.scores, size=cells, mode="constant")
        row, column = np.unravel_index(int(np.argmax(within)), within.shape)
        east_m, north_m = self.worth.centres_m[row, column]
        return (float(east_m), float(north_m))

    def _nearest(self, half_m: float) -> tuple[float, float]:
        """Middle of the square nearest to the start that has its room on the ground, about."""
        inner = self.ground.buffer(-half_m)
        shape = self.ground if inner.is_empty else inner
        place = nearest_points(shape, Point(self.pricing.start))[0]
        return (float(place.x), float(place.y))
