"""Within what a SAR pass counts: where its processor can focus, in the geometry the pass was laid for.

Whoever builds an image of a flown line corrects for what the navigation system measured, but only so far: the
beam of every pulse of an aperture must have lain on the place (I. G. Cumming and F. H. Wong, "Digital
Processing of Synthetic Aperture Radar Data", 2005, chapter 4), and the correction is exact for one range and
one direction alone, so that the line must stay near the straight one (G. Fornaro, "Trajectory deviations in
airborne SAR: analysis and compensation", IEEE Trans. AES 35(3), 1999).
"""

from __future__ import annotations

import math

from planner.sensors.sar import SarSensor

#: Roll and pitch to either side. Beyond it the gain and the range gate are those of another swath; level
#: passes of the autopilots stay within 3° (docs/coverage.md, margins).
MAX_BANK_RAD = math.radians(10.0)
MAX_PITCH_RAD = math.radians(10.0)
#: Antennas are mounted for the attitude that the aircraft cruises with: pitch counts from its median while
#: the sensor was on, as far as that is within this of level. What hovers leans into its way, at 20 m/s by
#: 20°, so that its antenna hangs in a mount that keeps it level along the way.
MAX_TRIM_RAD = math.radians(5.0)
#: From the straight line over an aperture: UAVSAR flies its passes within a tube of 5 m radius (S. N. Madsen
#: et al., "UAV-based L-band SAR with precision flight path control", Proc. SPIE 5661, 2004).
MAX_OFF_LINE_M = 5.0
#: Between the course flown and that of the planned pass: the same side of the same ground is seen.
MAX_OFF_COURSE_RAD = math.radians(10.0)
#: Slant ranges nearer or farther than those of the planned pass by this part lie outside its range gate.
RANGE_PART = 0.1

#: Photos: the axis from where it was to look, beyond which it was turned away from what it was to see.
MAX_TURNED_RAD = math.radians(30.0)
#: Ground seen farther from the vertical lies flat before the horizon, where neither an image maps it nor the
#: height is known well enough.
FLATTEST_RAD = math.radians(75.0)
#: A ground sampled distance counts as kept up to this part more: heights over ground are known no better.
GSD_PART = 0.02


def look_range_rad(sensor: SarSensor, flown_m: float, planned_m: float) -> tuple[float, float] | None:
    """Look angles from the vertical between which ground counts; None where there are none.

    The sensor's incidence is that of its beam held level, and its slant ranges are those of that beam from
    the height that the pass was planned at.

    Parameters
    ----------
    flown_m, planned_m
        Height over the ground, as flown and as planned.
    """
    if flown_m <= 0.0 or planned_m <= 0.0:
        return None
    least, most = sensor.steepest_rad, sensor.flattest_rad
    farthest = flown_m * math.cos(most) / ((1.0 + RANGE_PART) * planned_m)
    nearest = flown_m * math.cos(least) / ((1.0 - RANGE_PART) * planned_m)
    if farthest >= 1.0:
        return None
    low, high = max(least, math.acos(min(nearest, 1.0))), min(most, math.acos(farthest))
    return (low, high) if low < high else None
