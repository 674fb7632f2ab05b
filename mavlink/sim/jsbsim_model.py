"""JSBSim's Cessna 172P under a simple autopilot, as a second opinion on the kinematic model.

JSBSim (jsbsim.sourceforge.net) integrates the six-degree-of-freedom equations with a full aerodynamic table
of the aircraft, so bank, speed and climb interact here: a steep turn costs height and speed, a climb costs
speed. It is a one-tonne aircraft that cruises at 38 to 60 m/s; at 50 m/s and 30 degrees of bank its turn
radius is 440 m. Smaller powered aircraft do not come with the package.
"""

from __future__ import annotations

import math
from dataclasses import replace
from importlib import import_module
from typing import Any

from mavlink.sim.dynamics import (
    JSBSIM_FASTEST_M_S,
    JSBSIM_SLOWEST_M_S,
    AircraftState,
    FlightCommand,
    Limits,
    Wind,
)
from mavlink.sim.kinematic import KinematicModel

_FT_M = 0.3048
_KNOT_M_S = 0.514444
_W_PER_HP = 745.6998715822702
_LAUNCH_HEIGHT_M = 15.0
_LARGEST_PITCH_RAD = math.radians(15.0)
_LARGEST_BANK_RAD = math.radians(45.0)


class JsbsimModel:
    """The flight model; ground runs are the kinematic model's.

    On a launch the aircraft is set into the air 15 m up in trimmed flight when the ground run reaches
    lift-off speed; on touching down the run-out is kinematic again. Only the flight between the two is
    JSBSim's.

    Parameters
    ----------
    ground
        Kinematic model of the aircraft standing on the ground.

    Raises
    ------
    ImportError
        The jsbsim package is not installed.
    ValueError
        The airspeed is not one this aircraft flies.
    """

    def __init__(self, ground: KinematicModel, limits: Limits, wind: Wind, *, ground_m: float) -> None:
        if not JSBSIM_SLOWEST_M_S <= limits.airspeed_m_s <= JSBSIM_FASTEST_M_S:
            raise ValueError(
                f"JSBSim's c172p flies {JSBSIM_SLOWEST_M_S:.0f} to {JSBSIM_FASTEST_M_S:.0f} m/s, "
                f"not {limits.airspeed_m_s:g}; use the kinematic model"
            )
        try:
            jsbsim: Any = import_module("jsbsim")
        except ImportError as error:
            raise ImportError("dynamics 'jsbsim' needs the jsbsim package (extra 'jsbsim')") from error
        # It greets on standard output otherwise.
        jsbsim.FGJSBBase().debug_lvl = 0
        self._jsbsim = jsbsim
        self._ground = ground
        self._limits = limits
        self._wind = wind
        self._ground_m = ground_m
        self._exec: Any = None
        self._climb_integral = 0.0
        self._speed_integral = 0.0
        self.step_s = ground.step_s
        self._state = ground.state

    @property
    def state(self) -> AircraftState:
        """The state after the last step."""
        return self._state

    def step(self, dt_s: float, command: FlightCommand) -> AircraftState:
        """Advance by ``dt_s`` seconds; JSBSim itself runs at 120 Hz."""
        if self._exec is None:
            self._state = self._ground.step(dt_s, command)
            if not self._state.on_ground:
                self._lift_off()
            return self._state
        self._state = self._fly(dt_s, command)
        if self._state.altitude_m <= self._ground_m and self._state.climb_m_s <= 0.0:
            self._exec = None
            self._state = replace(
                self._state,
                altitude_m=self._ground_m,
                climb_m_s=0.0,
                bank_rad=0.0,
                pitch_rad=0.0,
                on_ground=True,
            )
            self._ground.reset(self._state)
        return self._state

    def _lift_off(self) -> None:
        state = self._state
        fdm = self._jsbsim.FGFDMExec(None)
        fdm.set_debug_level(0)
        fdm.load_model("c172p")
        fdm.set_dt(1.0 / 120.0)
        fdm["ic/lat-geod-deg"] = state.lat_deg
        fdm["ic/long-gc-deg"] = state.lon_deg
        fdm["ic/h-sl-ft"] = (self._ground_m + _LAUNCH_HEIGHT_M) / _FT_M
        fdm["ic/terrain-elevation-ft"] = 0.0
        fdm["ic/psi-true-deg"] = math.degrees(state.heading_rad)
        fdm["ic/vt-fps"] = self._limits.airspeed_m_s / _FT_M
        fdm["ic/gamma-deg"] = 0.0
        fdm["propulsion/magneto_cmd"] = 3
        fdm["fcs/mixture-cmd-norm"] = 0.9
        fdm["fcs/throttle-cmd-norm"] = 0.8
        fdm.run_ic()
        fdm["propulsion/set-running"] = -1
        self._exec = fdm
        self._speed_integral = 0.7
        self._climb_integral = math.radians(3.0)
        self._state = self._read(state.time_s)

    def _fly(self, dt_s: float, command: FlightCommand) -> AircraftState:
        fdm = self._exec
        wind_north, wind_east = self._wind.step(dt_s)
        fdm["atmosphere/wind-north-fps"] = wind_north / _FT_M
        fdm["atmosphere/wind-east-fps"] = wind_east / _FT_M
        for _ in range(round(dt_s * 120.0)):
            self._steer(command)
            if not fdm.run():
                raise RuntimeError("JSBSim stopped")
        return self._read(self._state.time_s + dt_s)

    def _steer(self, command: FlightCommand) -> None:
        """One pass of the inner loops: bank to aileron, climb to pitch to elevator, airspeed to throttle."""
        fdm, limits = self._exec, self._limits
        bank_limit = min(limits.max_bank_rad, _LARGEST_BANK_RAD)
        bank = min(max(command.bank_rad, -bank_limit), bank_limit)
        phi, p = fdm["attitude/phi-rad"], fdm["velocities/p-rad_sec"]
        fdm["fcs/aileron-cmd-norm"] = _unit(1.6 * (bank - phi) - 0.35 * p)
        airspeed = fdm["velocities/ve-kts"] * _KNOT_M_S
        climb = fdm["velocities/h-dot-fps"] * _FT_M
        wanted = min(max(command.climb_m_s, -limits.sink_m_s), limits.climb_m_s)
        error = (wanted - climb) / max(airspeed, 20.0)
        self._climb_integral = min(max(self._climb_integral + 0.5 * error / 120.0, -0.15), 0.2)
        # Too slow, height must wait: the nose comes down before the wing stalls.
        slow = min(max((airspeed - 0.8 * limits.airspeed_m_s) / 3.0, -1.0), 0.0)
        pitch = min(max(self._climb_integral + 0.8 * error, -_LARGEST_PITCH_RAD), _LARGEST_PITCH_RAD)
        pitch += math.radians(8.0) * slow
        theta, q = fdm["attitude/theta-rad"], fdm["velocities/q-rad_sec"]
        fdm["fcs/elevator-cmd-norm"] = _unit(
            -4.0 * (pitch - theta) + 1.2 * q - 0.3 * (1.0 / math.cos(phi) - 1.0)
        )
        fdm["fcs/rudder-cmd-norm"] = _unit(-0.8 * fdm["aero/beta-rad"])
        speed_error = command.airspeed_m_s - airspeed
        self._speed_integral = min(max(self._speed_integral + 0.02 * speed_error / 120.0, 0.0), 1.0)
        fdm["fcs/throttle-cmd-norm"] = min(max(self._speed_integral + 0.1 * speed_error, 0.0), 1.0)

    def _read(self, time_s: float) -> AircraftState:
        fdm = self._exec
        north = fdm["velocities/v-north-fps"] * _FT_M
        east = fdm["velocities/v-east-fps"] * _FT_M
        return AircraftState(
            time_s=time_s,
            lat_deg=fdm["position/lat-geod-deg"],
            lon_deg=fdm["position/long-gc-deg"],
            altitude_m=fdm["position/h-sl-ft"] * _FT_M,
            heading_rad=fdm["attitude/psi-rad"] % (2.0 * math.pi),
            bank_rad=fdm["attitude/phi-rad"],
            pitch_rad=fdm["attitude/theta-rad"],
            airspeed_m_s=fdm["velocities/vtrue-fps"] * _FT_M,
            climb_m_s=fdm["velocities/h-dot-fps"] * _FT_M,
            north_m_s=north,
            east_m_s=east,
            wind_north_m_s=fdm["atmosphere/wind-north-fps"] * _FT_M,
            wind_east_m_s=fdm["atmosphere/wind-east-fps"] * _FT_M,
            turn_rate_rad_s=fdm["velocities/psidot-rad_sec"],
            throttle=fdm["fcs/throttle-cmd-norm"],
            power_w=fdm["propulsion/engine/power-hp"] * _W_PER_HP,
            on_ground=False,
        )


def _unit(value: float) -> float:
    return min(max(value, -1.0), 1.0)
