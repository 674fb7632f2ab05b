"""One aircraft of several: what its stages are told, and the ways it can do each job."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.visible import Seeing
from planner.coverage.ways import Options
from planner.errors import Finding, InfeasibleError
from planner.fleet.problem import Travel
from planner.profile.ends import climb_slope_rad, sink_slope_rad, with_run
from planner.route import Terminal
from planner.routing.joint.chain import estimates, from_start, to_end
from planner.scenario import Scenario
from planner.tasks.fleet.jobs import Job
from planner.tasks.fleet.looks import Looks
from planner.tasks.fleet.ways import Ways, best_ways
from planner.tasks.flying import FlightLevels
from planner.tasks.setting import Setting, seeing
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.energy import FlightState
from planner.vehicle.manners import manners_of
from planner.wishes import Region

Floats = NDArray[np.float64]

#: A change of height takes so much more than its slope says, in turn radii: some of the leg is turns.
LEVEL_OFF = 0.5
#: No touch-down is thought slower.
MIN_LAND_M_S = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Crew:
    """One aircraft.

    Parameters
    ----------
    alone
        The scenario as it is asked of this aircraft.
    ends
        Its own, the start with the run that a flight begins with.
    power_w
        At cruise; None without a power model.
    landings
        Where it may end, the end of ``ends`` first.
    looks
        What crews of its kind have seen of jobs.
    """

    aircraft: Aircraft
    alone: Scenario
    setting: Setting
    asked: Seeing
    around: Surroundings
    ends: tuple[Terminal, Terminal]
    power_w: float | None
    landings: tuple[Terminal, ...]
    looks: Looks = field(default_factory=Looks)

    @classmethod
    def of(cls, scenario: Scenario, aircraft: Aircraft) -> Crew:
        """The crew of an aircraft of a scenario.

        Raises
        ------
        InfeasibleError
            ``"wind"``: it is not faster than the wind.
        """
        # A battery is changed, or the next one takes off, where an aircraft has landed.
        several = aircraft.batteries > 1 or aircraft.end_bases is not None
        shared = len(scenario.aircraft) > 1 or several
        landing = replace(aircraft, finish="land") if shared and aircraft.finish == "auto" else aircraft
        alone = replace(scenario.of_one(aircraft), aircraft=(landing,))
        setting = Setting.of(alone)
        asked = seeing(alone, setting)
        model = setting.model
        power = model.aircraft.power
        state = FlightState(model.airspeed_m_s, 0.0, 1.0, setting.level.amsl_m)
        return cls(
            landing,
            alone,
            setting,
            asked,
            asked.surroundings(),
            with_run(setting.ends, setting.level.height_m, model),
            None if power is None else power.power_w(state),
            scenario.landings_of(aircraft),
        )

    def landing(self, end: Terminal) -> Crew:
        """The same that ends at another of its landings."""
        return self.between((self.setting.ends[0], end))

    def between(self, ends: tuple[Terminal, Terminal]) -> Crew:
        """The same that starts where it once landed, or ends at another of its landings."""
        if ends == self.setting.ends:
            return self
        plain = replace(self.aircraft, base=None, end_bases=None)
        moved = replace(self.alone, start=ends[0], end=ends[1], bases=(), aircraft=(plain,))
        alone, setting = moved.home_from(ends[0]), replace(self.setting, ends=ends)
        if alone.home_amsl_m != moved.home_amsl_m:
            setting = replace(setting, airspace=alone.airspace, level=alone.level)
        return replace(self, alone=alone, setting=setting, ends=self._run(ends))

    def _run(self, ends: tuple[Terminal, Terminal]) -> tuple[Terminal, Terminal]:
        return with_run(ends, self.over_m(ends[0]), self.setting.model)

    def over_m(self, end: Terminal) -> float:
        """How high over the ground of a start or an end the route is."""
        levels = FlightLevels(self.setting.airspace, self.setting.level)
        return levels.altitude_m - levels.ground_m(end.ground)

    @property
    def kind(self) -> tuple[object, ...]:
        """What the ways of two crews are the same by."""
        plain = replace(
            self.aircraft, name="", base=None, end_bases=None, energy_wh=None, power=None, max_range_m=None,
            max_flight_time_s=None, batteries=1, turnaround_s=0.0, reserve=0.0,
        )  # fmt: skip
        return (plain, self.setting.suite)

    def seen(self, job: Job) -> tuple[int, ...]:
        """Numbers of a job's targets among the looks.

        Raises
        ------
        InfeasibleError
            Where it cannot be seen.
        """
        asked = replace(self.asked, regions=(job.asked,))
        return self.looks.numbers(job.asked, lambda: asked.visible(self.around).targets)

    def ways(self, job: Job) -> Ways:
        """The ways to do a job.

        Raises
        ------
        InfeasibleError
            Where there are none.
        """
        coarse = self.looks.coarse(self.seen(job))
        first = coarse[0]
        # Of a divided region the parts follow each other as they come; the ways differ in their ends.
        inner_m, exits = self._on(first, coarse[1:])
        found = best_ways(first.entries, exits, inner_m)
        if not len(found.inner_m):
            raise InfeasibleError(
                "transit", job.of, "no line leads from one of its parts to the next", "Draw them as regions."
            )
        return found

    def _on(self, first: Options, others: Sequence[Options]) -> tuple[Floats, Floats]:
        """From each option of a first target through all others: what it costs, and where it ends."""
        costs_m, exits = np.asarray(first.inner_m), np.asarray(first.exits)
        for other in others:
            legs_m = estimates(exits, other.entries, self.around, self.around.discs) + other.inner_m[None, :]
            picked = legs_m.argmin(axis=1)
            costs_m = costs_m + legs_m[np.arange(len(picked)), picked]
            exits = np.asarray(other.exits)[picked]
        return costs_m, exits

    @property
    def besides_s(self) -> float:
        """What a flight of one that hovers takes besides its way over the ground: up and down on the spot."""
        model = self.setting.model
        if not model.aircraft.hovers:
            return 0.0
        manners, (start, end) = manners_of(model.aircraft), self.ends
        landing_s = manners.land_below_m / max(manners.land_m_s, MIN_LAND_M_S)
        return self.over_m(start) / manners.climb_m_s + self.over_m(end) / manners.sink_m_s + landing_s

    def up_m(self, legs_m: Floats, start: Terminal) -> Floats:
        """Legs from a start with the circles that a climb takes besides where they are short."""
        if self.ends[0].over_home_m is not None:
            return legs_m
        return self._with_circles(legs_m, self.over_m(start), climb_slope_rad(self.setting.model))

    def down_m(self, legs_m: Floats, end: Terminal) -> Floats:
        """Legs to an end with the circles that a descent takes besides."""
        return self._with_circles(legs_m, self.over_m(end), sink_slope_rad(self.setting.model))

    def _with_circles(self, legs_m: Floats, height_m: float, slope_rad: float) -> Floats:
        model = self.setting.model
        if model.aircraft.hovers:
            return legs_m
        circle_m = math.tau * model.turn_radius_m
        wanted_m = height_m / math.tan(slope_rad) + LEVEL_OFF * model.turn_radius_m
        lacking_m = wanted_m - legs_m
        return legs_m + circle_m * np.ceil(np.maximum(lacking_m, 0.0) / circle_m)

    def seconds(
        self, entries: Floats, exits: Floats
    ) -> tuple[Floats, tuple[Floats, ...], tuple[Floats, ...]]:
        """Seconds between ways (N, N), from the start and from each landing (N,), to each landing (N,)."""
        starts = [self.ends[0], *(self._run((landing, self.ends[1]))[0] for landing in self.landings)]
        discs, speed_m_s = self.around.discs, self.setting.model.airspeed_m_s
        between = estimates(exits, entries, self.around, discs) / speed_m_s
        out = tuple(
            self.up_m(from_start(start, self.around, entries, discs), start) / speed_m_s for start in starts
        )
        home = tuple(
            self.down_m(to_end(end, self.around, exits, discs), end) / speed_m_s for end in self.landings
        )
        return between, out, home

    def thought_s(self, numbers: Sequence[int]) -> float:
        """How long a flight takes by targets in an order; infinity where no line leads through.

        Parameters
        ----------
        numbers
            Of the targets among the looks.
        """
        choice = self.looks.refined(self.ends, self.around, numbers)
        legs_m = (
            from_start(self.ends[0], self.around, choice.picked[0].entries, self.around.discs),
            to_end(self.ends[1], self.around, choice.picked[-1].exits, self.around.discs),
        )
        up_m, down_m = self.up_m(legs_m[0], self.ends[0]), self.down_m(legs_m[1], self.ends[1])
        more_m = float((up_m - legs_m[0] + down_m - legs_m[1])[0])
        return (choice.cost_m + more_m) / self.setting.model.airspeed_m_s

    def travel(self, seconds: Floats, power: float) -> Travel:
        """What ways of so many seconds take of everything, at a mean power by that at cruise."""
        return Travel(
            seconds,
            seconds * self.setting.model.airspeed_m_s,
            None if self.power_w is None else seconds * (power * self.power_w / 3600.0),
        )


def crews_of(
    scenario: Scenario, some: Sequence[Aircraft] | None = None
) -> tuple[tuple[Crew, ...], tuple[Finding, ...]]:
    """One for each aircraft that can fly in the wind, and what is said of those that stay on the ground.

    Parameters
    ----------
    some
        Of the scenario's aircraft; None for all.

    Raises
    ------
    InfeasibleError
        ``"wind"``: none can, or one that flies already cannot.
    """
    crews: list[Crew] = []
    looks: dict[tuple[object, ...], Looks] = {}
    said: list[Finding] = []
    refused: InfeasibleError | None = None
    for aircraft in scenario.aircraft if some is None else some:
        try:
            crew = Crew.of(scenario, aircraft)
            crews.append(replace(crew, looks=looks.setdefault(crew.kind, crew.looks)))
        except InfeasibleError as error:
            if error.constraint != "wind" or aircraft.aloft is not None:
                raise
            refused = refused or error
            said.append(not_flown(aircraft.name, error))
    if refused is not None and not crews:
        raise refused
    return tuple(crews), tuple(said)


def not_flown(name: str, error: InfeasibleError) -> Finding:
    """What is said of an aircraft that stays on the ground."""
    message = f"does not fly: {error.message}" if error.feature == name else f"does not fly: {error}"
    return Finding(name, f"not-flown-{error.constraint}", message, error.relaxation, "warning")


def left_by(
    grounded: Sequence[Finding], crews: Sequence[Crew], regions: Iterable[Region]
) -> dict[str, Finding]:
    """Regions that only aircraft see which stay on the ground, by their names, and what is said of them.

    Raises
    ------
    InfeasibleError
        Where one is required.
    """
    able = {region.name for crew in crews for region in crew.alone.regions}
    why = "; ".join(f"{finding.feature} {finding.message}" for finding in grounded)
    found: dict[str, Finding] = {}
    for region in regions if grounded else ():
        if region.name in able:
            continue
        message = f"is seen by none that flies: {why}"
        error = InfeasibleError("wind", region.name, message, grounded[0].fix)
        if region.required:
            raise error
        found[region.name] = not_seen(Job(region, region.name), error)
    return found


def ways_of(
    crews: Sequence[Crew], jobs: Iterable[Job], instead: Callable[[Crew, Job], Ways] | None = None
) -> tuple[dict[tuple[str, int], Ways], dict[str, Finding]]:
    """The ways of each job by its name and the number of a crew; crews of one kind share them.

    ``instead`` finds those of a job that has none.

    Returns
    -------
    tuple
        The ways; and why a job has none at all, by its name.
    """
    found: dict[tuple[str, int], Ways] = {}
    why: dict[str, Finding] = {}
    known: dict[tuple[object, ...], Ways | InfeasibleError] = {}
    for job in jobs:
        refused: InfeasibleError | None = None
        for number, crew in enumerate(crews):
            if not any(region.name == job.of for region in crew.alone.regions):
                continue
            key = (job.region.name, crew.kind)
            if key not in known:
                known[key] = _ways_or_why(crew, job, instead)
            ways = known[key]
            if isinstance(ways, InfeasibleError):
                refused = ways
            else:
                found[job.region.name, number] = ways
        if refused is not None and not any(name == job.region.name for name, _ in found):
            if job.region.required:
                raise refused
            why[job.region.name] = not_seen(job, refused)
    return found, why


def _ways_or_why(crew: Crew, job: Job, instead: Callable[[Crew, Job], Ways] | None) -> Ways | InfeasibleError:
    try:
        return crew.ways(job)
    except InfeasibleError as error:
        try:
            return error if instead is None else instead(crew, job)
        except InfeasibleError:
            return error


def not_seen(job: Job, refused: InfeasibleError) -> Finding:
    """What is said of a region that is left out for a reason."""
    rule = f"not-seen-{refused.constraint}"
    return Finding(job.of, rule, refused.message, refused.relaxation, "warning")


def takes_s(job: Job, crews: Sequence[Crew], ways: Mapping[tuple[str, int], Ways]) -> float:
    """The least that any crew takes for a job."""
    times_s = [
        float(found.inner_m.min()) / crew.setting.model.airspeed_m_s
        for number, crew in enumerate(crews)
        if (found := ways.get((job.region.name, number))) is not None
    ]
    return min(times_s, default=math.inf)


def most_s(crew: Crew) -> float:
    """How long one flight of a crew may last."""
    aircraft = crew.setting.model.aircraft
    limits = [math.inf if aircraft.max_flight_time_s is None else aircraft.max_flight_time_s]
    if aircraft.max_range_m is not None:
        limits.append(aircraft.max_range_m / aircraft.airspeed_m_s)
    if aircraft.usable_wh is not None and crew.power_w:
        limits.append(3600.0 * aircraft.usable_wh / crew.power_w)
    model, (up_m, down_m) = crew.setting.model, map(crew.over_m, crew.ends)
    levels_m = up_m / math.tan(climb_slope_rad(model)) + down_m / math.tan(sink_slope_rad(model))
    besides_s = crew.besides_s or levels_m / model.airspeed_m_s / 2.0
    return max(min(limits) - besides_s, 1.0)
