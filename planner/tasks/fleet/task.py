"""Rounds of who does what: assigned, flown, put on one clock, and what that teaches fed back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from planner.errors import Finding, InfeasibleError, nothing_seen
from planner.fleet.assignment import Assignment, Trip
from planner.fleet.assignment import LeftOut as Unassigned
from planner.fleet.problem import Problem
from planner.plan import LeftOut
from planner.scenario import Scenario
from planner.tasks.fleet.aloft import homewards
from planner.tasks.fleet.alone import Alone
from planner.tasks.fleet.answer import FleetAnswer
from planner.tasks.fleet.barred import BarredError, barred, infeasible
from planner.tasks.fleet.bettering import Hand, bettered
from planner.tasks.fleet.crews import Crew, crews_of, left_by, not_seen
from planner.tasks.fleet.crossing import crossed
from planner.tasks.fleet.deciding import AUTO, decided, decided_by, methods_of
from planner.tasks.fleet.flights import in_best_order, in_given_order, in_order
from planner.tasks.fleet.flown import Flown, Order, over
from planner.tasks.fleet.held import over_together, shorten, too_many_items
from planner.tasks.fleet.jobs import Job
from planner.tasks.fleet.keeping import kept_or
from planner.tasks.fleet.parts import Cutting
from planner.tasks.fleet.placing import CROWDED, Errand, LateError, Sortie, cost_of, placed, powers_of
from planner.tasks.fleet.problem import Lessons, ends_of, problem_of
from planner.tasks.fleet.splitting import with_more_flights
from planner.tasks.fleet.spreading import Known, spread
from planner.tasks.fleet.told import told_of, too_late
from planner.tasks.methods import chosen_methods
from planner.tasks.task import Controls
from planner.tasks.urban import cut_by_obstacles, lanes_cut

#: Rounds of assignment and flight, and of those that gave a plan; so many where an assignment is proved, for
#: that takes little: what it is proved for are estimates, and flights teach better ones.
MOST_ROUNDS, ROUNDS, PROVED_ROUNDS = 8, 2, 6
#: Flights of so few regions are chosen by all that one aircraft has; of more by the order that was assigned.
FEW = 1
#: Times thought and flown that are this near teach nothing.
NEAR = 0.03
#: After a flight over a limit, or late, the next are thought this much the longer besides.
TIGHTER = 0.98


@dataclass(frozen=True, slots=True)
class _Made:
    """An assignment of jobs and its flights."""

    jobs: tuple[Job, ...]
    assigned: Assignment
    sorties: tuple[Sortie, ...]


Key = tuple[int, tuple[tuple[str, int], ...]]
#: The same, and the numbers of the bases where it starts and ends.
Landed = tuple[int, tuple[tuple[str, int], ...], int, int]


def fleet(scenario: Scenario, controls: Controls, lessons: Lessons | None = None) -> FleetAnswer:
    """Who does what, when, and the flights that do it.

    Parameters
    ----------
    lessons
        What is known beforehand.

    Raises
    ------
    InfeasibleError
        Where a required region cannot be done, with what binds and what would help.
    """
    rounds = _Rounds(scenario, controls, lessons or Lessons())
    try:
        answer = rounds.best()
    except InfeasibleError:
        if rounds.too_long is None:
            raise
        # Too many items are no reason to have no plan.
        answer = with_more_flights(rounds.too_long, controls, scenario.seed)
    where = (answer.separation, scenario.objective, controls, scenario.seed)
    over_others = crossed(answer.crews, answer.sorties, *where)
    return answer if over_together(answer.crews, over_others) else replace(answer, sorties=over_others)


class _Rounds:
    """The rounds of one scenario: what is known by crew and job, and what was flown."""

    def __init__(self, scenario: Scenario, controls: Controls, lessons: Lessons) -> None:
        self._scenario, self._controls = scenario, controls
        self._separation = scenario.kept_apart
        self._lessons = lessons
        #: The last answer that was given up for its items alone.
        self.too_long: FleetAnswer | None = None
        self._flown: dict[Landed, Flown] = {}
        self._orders: dict[Landed, Order] = {}
        self._given_up: dict[str, Finding] = {}
        self._barred: set[tuple[str, int]] = set()
        self._alone: Known = {}
        with controls.stage("options"):
            self._crews, self._grounded = crews_of(scenario)
            known = (self._crews, self._lessons, self._errand, self._given_up)
            self._single = Alone(scenario, controls, *known)
            self._given_up |= left_by(self._grounded, self._crews, scenario.regions)
            self._parts: dict[str, int] = {}
            self._spread()
            self._parts = self._cutting.first()
            if self._parts:
                self._spread()

    def _spread(self) -> None:
        named = {region.name: region for region in self._scenario.regions}
        shared_m = {name: self._cutting.shared_m(named[name]) for name in self._parts}
        cut = (self._crews, self._scenario.regions, self._parts, shared_m)
        found = spread(*cut, self._controls, self._alone)
        self._jobs, self._why, self._parts = found.jobs, found.why, found.parts
        self._ways = {key: ways for key, ways in found.ways.items() if key not in self._barred}

    def best(self) -> FleetAnswer:
        """Of the plans of a few rounds."""
        found: list[tuple[float, FleetAnswer, _Made]] = []
        failed: InfeasibleError | None = None
        least = math.inf
        flown: set[frozenset[Key]] = set()
        for number in range(MOST_ROUNDS):
            self._controls.progress("assign", number / MOST_ROUNDS)
            try:
                jobs, problem, assigned, errands = self._next()
            except InfeasibleError:
                if found:
                    break
                raise
            lacking = [each for each in assigned.left_out if each.required]
            if lacking:
                if found:
                    break
                nearest = min(lacking, key=lambda each: each.margin)
                if not self._lessons.closes_s and (nearest.margin < least or failed is None):
                    least, failed = nearest.margin, infeasible(jobs, nearest)
                if self._single.relearnt(self._ways, jobs, lacking) or self._cut_more(jobs, lacking):
                    continue
                raise failed or infeasible(jobs, nearest)
            if not assigned.trips:
                failed = failed or self._nothing_flown(jobs, assigned)
                break
            try:
                sorties, near = self._flight_plan(jobs, assigned, errands)
            except LateError as late:
                failed = self._late(late, jobs, assigned)
                continue
            except InfeasibleError as error:
                if found:
                    break
                failed = self._refused(error)
                continue
            if sorties is None:
                continue
            answer = self._answer(jobs, problem, assigned, sorties)
            if self._shortened(sorties):
                self.too_long = answer
                continue
            cost = cost_of(sorties, self._scenario.objective)
            found.append((cost, answer, _Made(jobs, assigned, sorties)))
            trips = frozenset(_key(jobs, trip) for trip in assigned.trips)
            most = PROVED_ROUNDS if assigned.status == "optimal" else ROUNDS
            if near or len(found) >= most or trips in flown or self._controls.enough():
                break
            flown.add(trips)
        if not found:
            raise failed or InfeasibleError(
                "energy", "scenario", "no assignment of the regions keeps within the aircraft's limits",
                "Raise the limits, or add batteries or aircraft.",
            )  # fmt: skip
        _, answer, made = min(found, key=lambda each: each[0])
        return self._bettered(made) or answer

    def _bettered(self, made: _Made) -> FleetAnswer | None:
        """What is better and close to the best that was flown; None where nothing is."""
        if decided_by(self._scenario.method) != AUTO or self._scenario.going_on is not None:
            return None
        seed, controls = self._scenario.seed, self._controls

        def clocked(errands: Sequence[Errand]) -> tuple[Sortie, ...]:
            with controls.stage("separation"):
                return placed(self._crews, errands, self._separation, controls, seed)

        hand = Hand(lambda trip: self._errand(made.jobs, trip), clocked)
        try:
            better = bettered(
                self._crews, made.jobs, self._ways, made.assigned, made.sorties, self._lessons,
                self._scenario.objective, hand, controls,
            )  # fmt: skip
        except InfeasibleError:
            # What is seen by itself alone is not to be estimated in an order.
            return None
        if better is None:
            return None
        return self._answer(made.jobs, better.problem, better.assigned, better.sorties)

    def _refused(self, error: InfeasibleError) -> InfeasibleError:
        """What is learnt of a flight that there is no room for; raised where that is no help."""
        if error.constraint == CROWDED:
            self._lessons.hurry(0, 1.0 / TIGHTER)
            return error
        named = {job.region.name: job for job in self._jobs}
        asked = [named[name] for name in error.feature.split("+") if name in named]
        if error.constraint != "window" or not asked or any(job.region.required for job in asked):
            raise error
        for job in asked:
            self._given_up[job.of] = not_seen(job, error)
        return error

    def _nothing_flown(self, jobs: Sequence[Job], assigned: Assignment) -> InfeasibleError:
        """What is said where no region is required, and none fits."""
        if assigned.left_out:
            return infeasible(jobs, min(assigned.left_out, key=lambda each: each.margin))
        return nothing_seen([*self._why.values(), *self._given_up.values()])

    def _next(self) -> tuple[tuple[Job, ...], Problem, Assignment, list[Errand]]:
        """The next assignment, all flights of which can be flown.

        Raises
        ------
        InfeasibleError
            Where no flight leads to a required region.
        """
        while True:
            jobs = tuple(
                job
                for job in self._jobs
                if job.of not in self._given_up and any(name == job.region.name for name, _ in self._ways)
            )
            problem = problem_of(self._crews, jobs, self._ways, self._scenario.objective, self._lessons)
            assigned = decided(problem, self._scenario.method, self._scenario.seed, self._controls)
            if decided_by(self._scenario.method) == AUTO:
                assigned = kept_or(self._scenario.going_on, self._crews, jobs, problem, assigned)
            if any(each.required for each in assigned.left_out):
                return jobs, problem, assigned, []
            try:
                errands = [self._errand(jobs, trip) for trip in assigned.trips]
                home = homewards(self._crews, assigned.trips, self._controls)
                errands += [Errand(trip, (), flown=flown) for trip, flown in home]
                return jobs, problem, assigned, errands
            except BarredError as refused:
                self._bar(refused)

    def _bar(self, refused: BarredError) -> None:
        """What an aircraft cannot fly to is for others; what none can is given up, unless it is required."""
        found = barred(self._crews[refused.crew], refused, self._controls)
        optional = [job for job, _ in refused.jobs if not job.region.required]
        if not found and optional:
            least = min(optional, key=lambda job: job.region.priority)
            self._given_up[least.of] = not_seen(least, refused.why)
            return
        if not found:
            raise refused.why
        for job, _ in refused.jobs:
            name, key = job.region.name, (job.region.name, refused.crew)
            if name not in found:
                continue
            self._barred.add(key)
            self._ways.pop(key, None)
            if any(other == name for other, _ in self._ways):
                continue
            if name != job.of:
                # None leads to a part of it: it is one, as it was asked for.
                self._parts[job.of] = 1
                self._spread()
                return
            if job.region.required:
                raise found[name]
            self._given_up[job.of] = not_seen(job, found[name])

    def _flight_plan(
        self, jobs: Sequence[Job], assigned: Assignment, errands: Sequence[Errand]
    ) -> tuple[tuple[Sortie, ...] | None, bool]:
        """The flights of an assignment on one clock, None where one is over a limit; whether as thought."""
        with self._controls.stage("separation"):
            sorties = placed(self._crews, errands, self._separation, self._controls, self._scenario.seed)
        told: dict[int, list[float]] = {}
        tighter: dict[int, float] = {}
        far = 0.0
        thought = {_key(jobs, trip): trip for trip in assigned.trips}
        for sortie in sorties:
            crew = sortie.flown.crew
            if not sortie.flown.jobs:
                continue
            trip = thought[crew, tuple((job.region.name, visit) for job, visit in sortie.flown.jobs)]
            waited_s = math.fsum(visit.wait_s for visit in trip.visits)
            thought_s = trip.duration_s - waited_s
            told.setdefault(crew, []).append(sortie.flown.duration_s - sortie.flown.waited_s - thought_s)
            far = max(far, abs(told[crew][-1]) / max(thought_s, 1.0))
            excess = over(self._crews[crew], sortie.flown)
            if excess:
                # Times and powers are learnt; of lengths that is all there is.
                least = excess[0].limit / excess[0].used if excess[0].constraint == "range" else 1.0
                tighter[crew] = min(tighter.get(crew, 1.0), TIGHTER * least)
        more = over_together(self._crews, sorties)
        tighter = {crew: TIGHTER * each.limit / each.used for crew, each in more.items()} | tighter
        for crew, part in tighter.items():
            self._lessons.tighten(crew, part)
        self._lessons.learn(told, self._crews)
        self._lessons.power.update(powers_of(self._crews, sorties))
        return (None if tighter else sorties), far <= NEAR

    def _shortened(self, sorties: Sequence[Sortie]) -> bool:
        """Whether a flight has more items than are held and can be two; the next ones are shorter then."""
        long = shorten(self._crews, sorties, self._lessons, TIGHTER)
        if long:
            self._parts = self._cutting.first() | self._parts
            self._spread()
        return long

    def _errand(self, jobs: Sequence[Job], trip: Trip) -> Errand:
        key = (*_key(jobs, trip), trip.start_base, trip.end_base)
        done = tuple((jobs[visit.target], visit.number) for visit in trip.visits)
        crew = self._crews[trip.member].between(ends_of(self._crews, trip))
        try:
            return self._flown_or_ordered(crew, trip, done, key)
        except InfeasibleError as error:
            raise BarredError(trip.member, done, error) from error

    def _flown_or_ordered(
        self, crew: Crew, trip: Trip, done: tuple[tuple[Job, int], ...], key: Landed
    ) -> Errand:
        if any(job.is_timed for job, _ in done):
            if key not in self._orders:
                with self._controls.stage("routing"):
                    self._orders[key] = in_order(crew, done, self._controls)
            return Errand(trip, done, order=self._orders[key], ends=crew.setting.ends)
        if key not in self._flown:
            fly = in_best_order if self._wants_all(crew, done) else in_given_order
            self._flown[key] = fly(crew, trip.member, done, self._controls)
        return Errand(trip, done, flown=self._flown[key], ends=crew.setting.ends)

    def _wants_all(self, crew: Crew, done: Sequence[tuple[Job, int]]) -> bool:
        """Whether a flight's regions ask for more than the best pass or sweep over each in turn."""
        methods = chosen_methods(self._scenario.method)
        asked = replace(crew.asked, regions=tuple(job.asked for job, _ in done))
        return (
            len(done) <= FEW
            or methods["routing"] != "joint"
            or methods["coverage"] != "sweeps"
            or crew.setting.airspace.terrain is not None
            or lanes_cut(asked)
            or cut_by_obstacles(asked)
        )

    def _late(self, late: LateError, jobs: Sequence[Job], assigned: Assignment) -> InfeasibleError:
        """What is learnt of a window that was missed; a region that need not be seen is given up at last."""
        self._lessons.late(late, jobs, assigned, TIGHTER)
        error = too_late(late)
        if not late.job.region.required:
            self._given_up[late.job.of] = not_seen(late.job, error)
        return error

    @property
    def _cutting(self) -> Cutting:
        return Cutting(self._crews, self._jobs, self._ways, self._lessons.most_s)

    def _cut_more(self, jobs: Sequence[Job], lacking: Sequence[Unassigned]) -> bool:
        """One part more of each region that did not fit; whether there was any."""
        whole = {region.name: region for region in self._scenario.regions}
        more: dict[str, int] = {}
        for each in lacking:
            job = jobs[each.target]
            count = self._parts.get(job.of, 1) + 1
            can = count <= self._cutting.most_parts(whole[job.of])
            more |= {job.of: count} if can and each.limit in ("flight-time", "range", "energy") else {}
        if more:
            self._parts = self._parts | more
            self._spread()
        return bool(more)

    def _answer(
        self, jobs: Sequence[Job], problem: Problem, assigned: Assignment, sorties: tuple[Sortie, ...]
    ) -> FleetAnswer:
        dropped = (*self._why.values(), *self._given_up.values())
        left = [LeftOut(f.feature, f.rule.removeprefix("not-seen-")) for f in dropped]
        dropped = (*self._grounded, *dropped)
        for each in assigned.left_out:
            job = jobs[each.target]
            margin = each.margin if math.isfinite(each.margin) else None
            left.append(LeftOut(job.of, each.limit, margin))
            rule = f"not-seen-{each.limit}"
            dropped += (Finding(job.of, rule, each.message, each.relaxation, "warning"),)
        dropped = (*dropped, *(told for s in sorties for told in too_many_items(self._crews, s.flown)))
        unique = {each.roi: each for each in left}
        method, until = self._scenario.method, (self._controls.stop, self._controls.enough)
        told, methods = told_of(problem, assigned, decided_by(method), *until), methods_of(method)
        return FleetAnswer(
            self._crews, sorties, methods, dropped, tuple(unique.values()), self._separation, told
        )


def _key(jobs: Sequence[Job], trip: Trip) -> Key:
    return trip.member, tuple((jobs[visit.target].region.name, visit.number) for visit in trip.visits)
