"""The plan itself."""

from __future__ import annotations

from dataclasses import dataclass

from planner.plan.aboard import STILL_AIR, PlanCamera, PlanVehicle, PlanWind
from planner.plan.fence import Fence
from planner.plan.flown import Collect, FlownPath, Transit
from planner.plan.metrics import Metrics, Violation
from planner.plan.seen import Footprint, Photos, Uncovered
from planner.plan.words import AltitudeReference, LonLat


@dataclass(frozen=True, slots=True)
class Plan:
    """Checked and measured; see contract role by role.

    ``home`` is where the vehicles take off (the scenario's start), ``end`` where they finish; both on the
    ground.
    """

    name: str
    vehicles: tuple[PlanVehicle, ...]
    altitude_m: float
    altitude_reference: AltitudeReference
    home: LonLat
    end: LonLat
    paths: tuple[FlownPath, ...]
    collects: tuple[Collect, ...]
    transits: tuple[Transit, ...]
    footprints: tuple[Footprint, ...]
    uncovered: tuple[Uncovered, ...]
    fence: Fence
    metrics: Metrics
    violations: tuple[Violation, ...]
    methods: dict[str, str]
    scenario_hash: str
    planner_version: str
    seed: int
    warnings: tuple[str, ...] = ()
    photos: tuple[Photos, ...] = ()
    cameras: tuple[PlanCamera, ...] = ()
    wind: PlanWind = STILL_AIR

    def path_of(self, vehicle: str) -> FlownPath:
        """The path of one vehicle."""
        return next(path for path in self.paths if path.vehicle == vehicle)

    def collects_of(self, vehicle: str) -> tuple[Collect, ...]:
        """The collects of one vehicle in flight order."""
        return tuple(sorted((c for c in self.collects if c.vehicle == vehicle), key=lambda c: c.seq))

    def photos_of(self, vehicle: str) -> tuple[Photos, ...]:
        """The photos of one vehicle, those of each collect together, in flight order."""
        return tuple(sorted((p for p in self.photos if p.vehicle == vehicle), key=lambda p: p.seq))

    def camera(self, sensor: str) -> PlanCamera | None:
        """The camera of a name; None where that sensor is none."""
        return next((camera for camera in self.cameras if camera.name == sensor), None)

    @property
    def hard_violations(self) -> tuple[Violation, ...]:
        """Violations that forbid an upload without an explicit override."""
        return tuple(violation for violation in self.violations if violation.hard)
