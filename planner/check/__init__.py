"""The independent judge of a plan.

It reads the published plan back from its WGS 84 line and judges that: not waypoints, not what the stages
believe. It shares no algorithm with them: radius from the vertices of the line, zones and coverage from
shapely, the footprint drawn anew from the sensor's angles.
"""

from planner.check.coverage import seen_times
from planner.check.footprints import footprint
from planner.check.kinematics import turn_radius_m
from planner.check.line import judge_line, tight_turns
from planner.check.times import line_s
from planner.check.verdict import Verdict, judge

__all__ = [
    "Verdict",
    "footprint",
    "judge",
    "judge_line",
    "line_s",
    "seen_times",
    "tight_turns",
    "turn_radius_m",
]
