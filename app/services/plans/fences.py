"""What becomes of a fence on board, told when a scenario is judged and planned."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import shapely
from shapely.geometry import Point, Polygon

from mavlink.dialects import dialect_for
from mavlink.encoding.fence import fence_items
from mavlink.encoding.fit import FAR_M, Piece, does_not_fit, fitted
from planner.airspace.shapes import DiscShape, hard_shapes
from planner.errors import Finding
from planner.plan import Plan
from planner.scenario import Scenario

FIX = "Draw zones and area with fewer corners, or leave zones out that the flight does not come near"


def fence_notes(plan: Plan) -> tuple[str, ...]:
    """What of a plan's fence will not be on board as drawn, by the autopilots that the plan names."""
    vehicles = {vehicle.name: vehicle for vehicle in plan.vehicles}
    notes: dict[str, None] = {}
    for path in plan.paths:
        vehicle = vehicles[path.vehicle]
        store = dialect_for(vehicle.autopilot, vehicle.type).fence_store
        notes |= dict.fromkeys(fence_items(plan, (path,), store)[1])
    return tuple(notes)


def fence_findings(scenario: Scenario) -> Iterator[Finding]:
    """A warning where zones and area will hardly fit on board, thinned and without those far away.

    The flight is not known yet: what it comes near is thinned less.
    """
    # The fence is of the things themselves.
    shapes = hard_shapes(replace(scenario.airspace, clearance_m=0.0), scenario.level)
    ends = [Point(end.position) for end in (scenario.start, scenario.end)]
    wanted = shapely.union_all([*(region.area for region in scenario.regions), *ends])
    pieces = [] if scenario.area is None else [Piece.polygon("area", _cornered(scenario.area), True)]
    for shape in shapes:
        if wanted.distance(shape.polygon()) > FAR_M:
            continue
        if isinstance(shape, DiscShape):
            pieces.append(Piece(shape.name, shape.polygon()))
        else:
            pieces.append(Piece.polygon(shape.name, _cornered(shape.area), False))
    for aircraft in scenario.aircraft:
        store = dialect_for(aircraft.autopilot, aircraft.type).fence_store
        kept, notes = fitted(pieces, [], store)
        told = does_not_fit(kept, store)
        if told in notes:
            yield Finding(f"vehicle {aircraft.name}", "fence-does-not-fit", told, FIX, "warning")


def _cornered(area: Polygon) -> Polygon:
    """The corners that a plan's fence has: reading a ring cut its edges fine."""
    return Polygon(shapely.get_coordinates(shapely.simplify(area.exterior, 0.05)))
