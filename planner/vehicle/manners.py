"""How an autopilot takes off, climbs and lands, as it comes from its makers.

The figures are defaults of parameters, named beside them; what a vehicle has instead is read and judged
before flight. Sources: the parameter references of ArduPilot 4.6 and PX4 v1.16.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from planner.vehicle.aircraft import Aircraft

#: Height over home to which wings take off straight ahead, and to which VTOLs hover.
TAKE_OFF_HEIGHT_M = 50.0
#: Where the straight approach of a wing begins, and how steep it is: PX4 allows FW_LND_ANG, 5°.
APPROACH_HEIGHT_M, APPROACH_SLOPE_DEG = 40.0, 4.0
#: VTOLs speed up ahead of where they hovered for half of VT_TRANS_TIMEOUT, and need 1.5 times the distance
#: that stopping takes at Q_TRANS_DECEL, VT_B_DEC_MSS.
VTOL_SPEED_UP_S, VTOL_BRAKING_M_S2, VTOL_STOPS = 7.5, 2.0, 1.5
#: Height over home of the circle that a return of ArduPlane ends in (RTL_ALTITUDE).
RETURN_HEIGHT_M = 100.0
#: What missions leave of arcs: chords with this error, no more than so much of the arc each.
CHORD_ERROR_M, LARGEST_STEP_RAD = 2.0, math.radians(45.0)
#: Places of a mission that are no farther apart along the path are one.
ONE_PLACE_M = 0.5
#: Multirotors count as taken off from here on.
LIFT_OFF_HEIGHT_M = 10.0


@dataclass(frozen=True, slots=True)
class Manners:
    """Rates and accelerations of one kind of aircraft under one autopilot.

    Parameters
    ----------
    climb_m_s, sink_m_s
        Fastest that heights are changed in flight.
    accel_m_s2, vertical_accel_m_s2
        Of what hovers: along and across its line, and up and down.
    jerk_m_s3
        How fast that acceleration changes.
    land_m_s, land_below_m
        Touch-down speed of what hovers, and the height under which it is flown.
    corner_m, corner_share
        How far before a corner it takes up the next line, and the share of its acceleration that it turns
        with there; 0 where it blends both lines by its jerk.
    land_from_m
        From this height on its descent slows down to the touch-down speed.
    take_off_m_s, take_off_below_m, take_off_accel_m_s2
        Its climb off the ground, up to a height.
    sharing
        How the parts of its airspeed share the tilt of what hovers: see ``planner.vehicle.wind``.
    height_reached_m
        So much under a height it counts as reached.
    """

    climb_m_s: float
    sink_m_s: float
    accel_m_s2: float = 0.0
    jerk_m_s3: float = 0.0
    vertical_accel_m_s2: float = 1.0
    land_m_s: float = 0.0
    land_below_m: float = 0.0
    corner_m: float = 0.0
    corner_share: float = 1.0
    land_from_m: float = 0.0
    take_off_m_s: float = 0.0
    take_off_below_m: float = 0.0
    take_off_accel_m_s2: float = 0.0
    height_reached_m: float = 0.0
    sharing: float = 2.0


#: TECS_CLMB_MAX, TECS_SINK_MAX; Q_ACCEL_Z, Q_LAND_SPEED (hover of quadplanes).
_PLANE = Manners(5.0, 5.0, land_m_s=0.5, land_below_m=6.0)
#: WPNAV_SPEED_UP, WPNAV_SPEED_DN, WPNAV_ACCEL, WPNAV_JERK, WPNAV_ACCEL_Z, LAND_SPEED, LAND_ALT_LOW; its
#: simulator's drag is that of each axis by itself, with the 1.5th power of the speed (``docs/flight.md``).
_COPTER = Manners(2.5, 1.5, 2.5, 1.0, 1.0, 0.5, 10.0, sharing=3.0)
#: FW_T_CLMB_R_SP, FW_T_SINK_R_SP; MPC_LAND_SPEED, MPC_LAND_ALT2 (hover of VTOLs).
_PX4_WING = Manners(3.0, 2.0, land_m_s=0.7, land_below_m=5.0)
#: MPC_Z_V_AUTO_UP, MPC_Z_V_AUTO_DN, MPC_ACC_HOR, MPC_JERK_AUTO, MPC_ACC_UP_MAX, MPC_LAND_SPEED,
#: MPC_LAND_ALT2, NAV_ACC_RAD, MPC_XY_TRAJ_P, MPC_LAND_ALT1; MPC_TKO_SPEED, MPC_LAND_ALT1, MPC_TKO_SPEED over
#: MPC_TKO_RAMP_T; NAV_MC_ALT_RAD.
_PX4_MULTIROTOR = Manners(3.0, 1.5, 3.0, 4.0, 4.0, 0.7, 5.0, 2.0, 0.5, 10.0, 1.5, 10.0, 0.5, 0.8)


def manners_of(aircraft: Aircraft) -> Manners:
    """Those of an aircraft's autopilot for its type."""
    hovers = aircraft.hovers
    if aircraft.autopilot == "px4":
        return _PX4_MULTIROTOR if hovers else _PX4_WING
    return _COPTER if hovers else _PLANE
