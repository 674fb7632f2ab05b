"""Settings of the simulated aircraft."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from importlib.util import find_spec

from mavlink.sim.dynamics import GRAVITY_M_S2, JSBSIM_FASTEST_M_S, JSBSIM_SLOWEST_M_S, Limits
from mavlink.sim.faults import parse_faults
from mavlink.sim.geodesy import MOST_LATITUDE_DEG, Place
from mavlink.sim.guidance import Tuning
from mavlink.sim.modes import Flavour

_LEAST_BANK_LIMIT_DEG = 45.0
_BANK_MARGIN_DEG = 15.0
_GREATEST_BANK_DEG = 65.0
_TILT_LIMIT_DEG = 35.0
#: WPNAV_RADIUS of ArduCopter and NAV_ACC_RAD of PX4's multirotors.
_WAYPOINT_RADIUS_M = 2.0
_L1_PERIOD_S = {"kinematic": 7.0, "jsbsim": 12.0}

#: Climbing and descending: TECS_CLMB_MAX, TECS_SINK_MAX; WPNAV_SPEED_UP, WPNAV_SPEED_DN; FW_T_CLMB_R_SP,
#: FW_T_SINK_R_SP; MPC_Z_V_AUTO_UP, MPC_Z_V_AUTO_DN, by default.
_RATES_M_S = {
    (Flavour.ARDUPILOT, False): (5.0, 5.0),
    (Flavour.ARDUPILOT, True): (2.5, 1.5),
    (Flavour.PX4, False): (3.0, 2.0),
    (Flavour.PX4, True): (3.0, 1.5),
}


@dataclass(frozen=True, slots=True)
class SimSettings:
    """Everything a simulated aircraft starts from.

    Parameters
    ----------
    home
        Where it stands; its altitude is that of the ground, above mean sea level, flat all round.
    vehicle_type
        ``fixed_wing`` or ``multirotor``.
    airspeed_m_s
        Of a multirotor: its speed over the ground, until the mission changes it.
    turn_radius_m
        Radius of loiters that name none, and what the bank limit must allow with a margin; a multirotor has
        no use for it.
    max_bank_deg
        None: 45 degrees, or 15 more than the turn radius needs at the airspeed, whichever is larger (65 at
        most); a multirotor's largest tilt, 35 degrees.
    wind_from_deg
        Where the steady wind comes from, clockwise from true north.
    speedup
        Simulated seconds per second while armed. Disarmed, time runs at its own pace.
    dynamics
        ``kinematic``, ``jsbsim``, or ``auto``: JSBSim's Cessna 172P where the package is installed and it
        flies the airspeed (38 to 60 m/s), the kinematic model otherwise, so also at the 20 m/s of a small
        UAV, for which JSBSim ships no powered aircraft.
    heading_deg
        Where it points on the ground; None: north, and at the place of the mission's take-off once that
        begins, as whoever launches it would point it.
    climb_m_s, sink_m_s
        Fastest that it climbs and descends; 0: as its autopilot does by default.
    l1_period_s
        Period of the lateral guidance; None: 7 s, and 12 s under JSBSim, whose roll is slower.
    rtl_altitude_m, take_off_height_m
        Heights above home of a return, and of PX4's take-off that names none.
    acceptance_m
        How far before a waypoint it counts as reached, where the item does not say; 0: when abeam of it, and
        2 m for a multirotor.
    sensor_relay, sensor_servo, sensor_actuator
        The output that switches the sensor; None: any relay or servo does.
    sensor_command
        A user command (31000-31014) that switches the sensor by its param 1.
    boot_s
        How long after its start it says that it is starting, in simulated time; it stores nothing meanwhile.
    sensor_reports
        Whether the sensor says by itself that it is on (``SAR_ON``); most do not.
    max_items
        Mission capacity; None: 655 for ArduPilot, 1000 for PX4.
    camera, gimbal
        Whether it carries a camera and a gimbal that are MAVLink components of their own.
    camera_interval_s
        Shortest time between two photos: what is ordered sooner comes later on ArduPilot, not at all on PX4.
    started_unix_s
        The time of day at its start, in seconds since 1970; 0: it does not know.
    firmware
        Major and minor number of the firmware's version; None: 4.6 for ArduPilot, 1.16 for PX4.
    signing_key
        32 bytes: it signs with this key, and hears nothing else, until another one is handed to it; empty: it
        signs once it is handed one.
    faults
        Names of ``mavlink.sim.faults.Fault``.
    vanish_after_items, vanish_for_s
        When and for how long the fault ``vanish_mid_upload`` strikes, in the link's time.
    """

    home: Place = field(default_factory=lambda: Place(47.3977, 8.5456, 488.0))
    heading_deg: float | None = None
    autopilot: Flavour = Flavour.ARDUPILOT
    vehicle_type: str = "fixed_wing"
    system_id: int = 1
    component_id: int = 1
    airspeed_m_s: float = 20.0
    turn_radius_m: float = 100.0
    max_bank_deg: float | None = None
    roll_rate_deg_s: float = 75.0
    climb_m_s: float = 0.0
    sink_m_s: float = 0.0
    l1_period_s: float | None = None
    wind_m_s: float = 0.0
    wind_from_deg: float = 0.0
    gust_m_s: float = 0.0
    seed: int = 0
    speedup: float = 1.0
    dynamics: str = "kinematic"
    battery_wh: float = 500.0
    cruise_power_w: float = 250.0
    mass_kg: float = 8.0
    rtl_altitude_m: float = 100.0
    take_off_height_m: float = 10.0
    acceptance_m: float = 0.0
    sensor_relay: int | None = None
    sensor_servo: int | None = None
    sensor_actuator: int = 1
    sensor_command: int = 31010
    camera: bool = True
    gimbal: bool = True
    camera_interval_s: float = 0.0
    started_unix_s: float = 0.0
    boot_s: float = 0.0
    sensor_reports: bool = True
    max_items: int | None = None
    firmware: tuple[int, int] | None = None
    signing_key: bytes = field(default=b"", repr=False)
    faults: tuple[str, ...] = ()
    vanish_after_items: int = 3
    vanish_for_s: float = 10.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "autopilot", Flavour(self.autopilot))
        for name, rate_m_s in zip(
            ("climb_m_s", "sink_m_s"), _RATES_M_S[self.autopilot, self.hovers], strict=True
        ):
            if getattr(self, name) == 0.0:
                object.__setattr__(self, name, rate_m_s)
        if self.vehicle_type == "vtol":
            raise ValueError(
                "no vtol is simulated: its transitions between rotors and wings are not; take fixed_wing or "
                "multirotor, or a real autopilot's simulator (docs/simulators.md)"
            )
        if self.vehicle_type not in ("fixed_wing", "multirotor"):
            raise ValueError(f"fixed_wing and multirotor are simulated, not {self.vehicle_type!r}")
        if self.dynamics not in ("auto", "kinematic", "jsbsim"):
            raise ValueError(f"dynamics is auto, kinematic or jsbsim, not {self.dynamics!r}")
        for name in ("airspeed_m_s", "turn_radius_m", "climb_m_s", "sink_m_s", "speedup"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} must be a positive number, not {value!r}")
        if not (math.isfinite(self.camera_interval_s) and self.camera_interval_s >= 0.0):
            raise ValueError(f"camera_interval_s must be 0 or more, not {self.camera_interval_s!r}")
        if self.l1_period_s is not None and not self.l1_period_s > 0.0:
            raise ValueError(f"l1_period_s must be a positive number, not {self.l1_period_s!r}")
        if self.dynamics == "jsbsim" and self.hovers:
            raise ValueError("JSBSim's c172p is a fixed wing; use the kinematic model for a multirotor")
        if self.dynamics == "jsbsim" and not self._suits_jsbsim:
            raise ValueError(
                f"JSBSim's c172p flies {JSBSIM_SLOWEST_M_S:.0f} to {JSBSIM_FASTEST_M_S:.0f} m/s, "
                f"not {self.airspeed_m_s:g}; use the kinematic model"
            )
        if not 0.0 <= self.wind_m_s < 0.9 * self.airspeed_m_s:
            raise ValueError(f"wind of {self.wind_m_s} m/s cannot be flown at {self.airspeed_m_s} m/s")
        if not abs(self.home.lat_deg) <= MOST_LATITUDE_DEG:
            raise ValueError(
                f"home latitude must be within {MOST_LATITUDE_DEG:g} degrees of the equator, "
                f"not {self.home.lat_deg}"
            )
        if self.max_bank_deg is not None and not 5.0 <= self.max_bank_deg <= 75.0:
            raise ValueError(f"max_bank_deg is 5 to 75 degrees, not {self.max_bank_deg!r}")
        needed_deg = math.degrees(math.atan(self.airspeed_m_s**2 / (GRAVITY_M_S2 * self.turn_radius_m)))
        if not self.hovers and needed_deg > _GREATEST_BANK_DEG - _BANK_MARGIN_DEG:
            raise ValueError(
                f"a turn of {self.turn_radius_m} m at {self.airspeed_m_s} m/s needs "
                f"{needed_deg:.0f} degrees of bank; the limit is {_GREATEST_BANK_DEG - _BANK_MARGIN_DEG:.0f}"
            )
        parse_faults(self.faults)

    @property
    def version(self) -> tuple[int, int]:
        """Of the firmware."""
        return self.firmware or ((4, 6) if self.autopilot is Flavour.ARDUPILOT else (1, 16))

    @property
    def hovers(self) -> bool:
        """Whether it is a multirotor."""
        return self.vehicle_type == "multirotor"

    @property
    def waypoint_radius_m(self) -> float:
        """A multirotor's acceptance distance where the item names none."""
        return self.acceptance_m or _WAYPOINT_RADIUS_M

    @property
    def _suits_jsbsim(self) -> bool:
        return JSBSIM_SLOWEST_M_S <= self.airspeed_m_s <= JSBSIM_FASTEST_M_S

    @property
    def flight_model(self) -> str:
        """``jsbsim`` or ``kinematic``, as ``auto`` decides."""
        if self.dynamics != "auto":
            return self.dynamics
        if self.hovers:
            return "kinematic"
        return "jsbsim" if self._suits_jsbsim and find_spec("jsbsim") is not None else "kinematic"

    @property
    def bank_limit_rad(self) -> float:
        """Largest bank."""
        if self.max_bank_deg is not None:
            return math.radians(self.max_bank_deg)
        if self.hovers:
            return math.radians(_TILT_LIMIT_DEG)
        needed_rad = math.atan(self.airspeed_m_s**2 / (GRAVITY_M_S2 * self.turn_radius_m))
        return max(math.radians(_LEAST_BANK_LIMIT_DEG), needed_rad + math.radians(_BANK_MARGIN_DEG))

    @property
    def limits(self) -> Limits:
        """The airframe's limits."""
        return Limits(
            airspeed_m_s=self.airspeed_m_s,
            max_bank_rad=self.bank_limit_rad,
            roll_rate_rad_s=math.radians(self.roll_rate_deg_s),
            climb_m_s=self.climb_m_s,
            sink_m_s=self.sink_m_s,
        )

    @property
    def tuning(self) -> Tuning:
        """Guidance tuning."""
        period_s = self.l1_period_s or _L1_PERIOD_S[self.flight_model]
        return Tuning(l1_period_s=period_s, max_bank_rad=self.bank_limit_rad)
