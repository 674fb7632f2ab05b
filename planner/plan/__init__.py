"""The plan: what comes out, in WGS 84 degrees and SI units, ready for GeoJSON and for MAVLink.

This is the one room of the planner that ``mavlink`` may import, so it imports nothing heavy and its values
are plain numbers and tuples. Distances along a path (``start_m`` …) count from the path's start.
"""

from planner.plan.aboard import PlanCamera, PlanVehicle, PlanWind
from planner.plan.fence import Fence, ZoneCircle, ZonePolygon
from planner.plan.flown import Collect, FlownPath, PathSegment, Phase, Transit
from planner.plan.metrics import Assigned, LeftOut, Metrics, Replanned, VehicleMetrics, Violation
from planner.plan.seen import Footprint, Photos, Surveyed, Uncovered
from planner.plan.whole import Plan
from planner.plan.words import (
    AltitudeReference,
    Finish,
    LonLat,
    LonLatAlt,
    PhaseKind,
    Ring,
    SegmentKind,
    Trigger,
)

__all__ = [
    "AltitudeReference",
    "Assigned",
    "Collect",
    "Fence",
    "Finish",
    "FlownPath",
    "Footprint",
    "LeftOut",
    "LonLat",
    "LonLatAlt",
    "Metrics",
    "PathSegment",
    "Phase",
    "PhaseKind",
    "Photos",
    "Plan",
    "PlanCamera",
    "PlanVehicle",
    "PlanWind",
    "Replanned",
    "Ring",
    "SegmentKind",
    "Surveyed",
    "Transit",
    "Trigger",
    "Uncovered",
    "VehicleMetrics",
    "Violation",
    "ZoneCircle",
    "ZonePolygon",
]
