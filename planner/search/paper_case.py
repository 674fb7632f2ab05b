"""The case of the paper on stored energy: a tenth of a Navion over its square.

The paper gives the square (773.36 m, 598,100 m²: what straight flight on all the energy sees), the camera's
radius (50 m), n (1.5), e (1), the motor's efficiency (0.9), charge and voltage (2,200 mAh at 11.1 V). The
text at hand has lost the rest, which is derived here:

- the geometry from the full-size Navion (R. C. Nelson, "Flight Stability and Automatic Control", 1998, app.
  B: 2,750 lb, 184 ft², span 33.4 ft, 176 ft/s): lengths by 10, area by 100, mass by 1,000, speed by √10;
- C_D0 from 598,100 m²: energy by efficiency over drag is the way, 5,981 m. It comes to 0.43, which is a lot:
  the drag of this model holds whatever else takes energy in the paper's;
- density at sea level; entry at the south-west corner to the north, exit at the south-east corner.
"""

from __future__ import annotations

import math

from shapely.geometry import box

from planner.search.course import DiscSearch, Glider
from planner.search.values import worth_of_ground
from planner.vehicle.energy import SEA_LEVEL_DENSITY_KG_M3, STANDARD_GRAVITY_M_S2, DragPolar

SIDE_M, STRAIGHT_M2, RADIUS_M = 773.36, 598_100.0, 50.0
EFFICIENCY, OSWALD, MAX_LOAD_FACTOR = 0.9, 1.0, 1.5
STORED_J = 2.2 * 11.1 * 3600.0
HEADING_RAD = math.pi / 2.0

_LB_KG, _FT_M, _SCALE = 0.45359237, 0.3048, 10.0
MASS_KG = 2750.0 * _LB_KG / _SCALE**3
WING_AREA_M2 = 184.0 * _FT_M**2 / _SCALE**2
ASPECT_RATIO = 33.4**2 / 184.0
AIRSPEED_M_S = 176.0 * _FT_M / math.sqrt(_SCALE)

#: Cells of the ground: so many to the disc's radius.
CELLS = 10.0


def navion() -> Glider:
    """The aircraft."""
    dynamic_n = 0.5 * SEA_LEVEL_DENSITY_KG_M3 * AIRSPEED_M_S**2 * WING_AREA_M2
    lift = MASS_KG * STANDARD_GRAVITY_M_S2 / dynamic_n
    drag = EFFICIENCY * STORED_J / (STRAIGHT_M2 / (2.0 * RADIUS_M)) / dynamic_n
    zero_lift = drag - lift**2 / (math.pi * OSWALD * ASPECT_RATIO)
    polar = DragPolar(MASS_KG, WING_AREA_M2, ASPECT_RATIO, zero_lift, OSWALD, EFFICIENCY)
    return Glider(polar, AIRSPEED_M_S, MAX_LOAD_FACTOR, STORED_J)


def paper_case() -> DiscSearch:
    """The aircraft over its square."""
    square = box(0.0, 0.0, SIDE_M, SIDE_M)
    worth = worth_of_ground(square, RADIUS_M / CELLS)
    return DiscSearch(square, worth, RADIUS_M, (0.0, 0.0), (SIDE_M, 0.0), navion())
