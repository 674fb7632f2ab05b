"""Multirotors: what the model can do, how legs, stops, pauses and landings are flown."""

from __future__ import annotations

import math

import pytest

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.dynamics import GRAVITY_M_S2, AircraftState, FlightCommand, HoverCommand, Limits, Wind
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.multirotor import MultirotorModel
from mavlink.sim.settings import SimSettings
from mavlink.state.modes import mode_name
from mavlink.wire.items import Command, MissionItem
from tests.mavlink.sim.helpers import HOME, Station, arc_waypoints, east_north_m, item, place_at, waypoint

FLAVOURS = list(Flavour)
SPEED_M_S = 12.0
LIMITS = Limits(SPEED_M_S, math.radians(35.0), 1.0, 5.0, 4.0)


def mission(flavour: Flavour, body: list[MissionItem]) -> list[MissionItem]:
    """Straight up to 60 m, then the body."""
    home = [item(Command.NAV_WAYPOINT, HOME)] if flavour is Flavour.ARDUPILOT else []
    return [
        *home,
        item(Command.NAV_TAKEOFF, Place(HOME.lat_deg, HOME.lon_deg, HOME.altitude_m + 60.0)),
        *body,
    ]


def taking_off(flavour: Flavour, body: list[MissionItem], **options: float) -> Station:
    s = Station(
        SimulatedAircraft(
            SimSettings(
                home=HOME,
                autopilot=flavour,
                vehicle_type="multirotor",
                airspeed_m_s=SPEED_M_S,
                rtl_altitude_m=80.0,
                **options,
            )
        )
    )
    assert s.upload(mission(flavour, body)) == 0
    s.start()
    return s


def here(state: AircraftState) -> tuple[float, float]:
    return east_north_m(state.lat_deg, state.lon_deg)


def mode(s: Station) -> str:
    """The mode as a ground station reads it from HEARTBEAT."""
    beat = s.aircraft.message("HEARTBEAT")
    assert beat is not None
    assert beat.integer("type") == 2
    autopilot = "px4" if s.aircraft.settings.autopilot is Flavour.PX4 else "ardupilot"
    return mode_name(autopilot, "multirotor", beat.integer("custom_mode"))


LAND = item(Command.NAV_LAND, HOME)


@pytest.mark.parametrize("wind_m_s", [0.0, 6.0])
def test_it_tilts_no_further_and_no_faster_than_it_can(wind_m_s: float) -> None:
    """From a standstill to full speed and back: tilt and jerk stay in their limits, the speed is reached.

    Wind across takes of it what the airspeed has to hold against.
    """
    model = MultirotorModel(LIMITS, HOME, 0.0, wind=Wind(wind_m_s, 90.0, 0.0, 0), ground_m=HOME.altitude_m)
    for _ in range(400):
        model.step(model.step_s, FlightCommand(climb_m_s=2.0, launch=True))
    speeds: list[float] = []
    thrust = (0.0, 0.0)
    for command in (HoverCommand(SPEED_M_S, 0.0), HoverCommand(0.0, 0.0)):
        for _ in range(600):
            state = model.step(model.step_s, FlightCommand(hover=command))
            tilted = math.hypot(math.tan(state.bank_rad), math.tan(state.pitch_rad))
            assert tilted <= math.tan(LIMITS.max_bank_rad) + 1e-9
            # Heading north: nose down is thrust to the north.
            now = (-GRAVITY_M_S2 * math.tan(state.pitch_rad), GRAVITY_M_S2 * math.tan(state.bank_rad))
            if speeds:
                assert math.dist(now, thrust) <= 15.0 * model.step_s + 1e-9
            thrust = now
            speeds.append(state.north_m_s)
        reached_m_s = math.sqrt(SPEED_M_S**2 - wind_m_s**2) if command.north_m_s else 0.0
        assert state.north_m_s == pytest.approx(reached_m_s, abs=0.05)
        assert state.east_m_s == pytest.approx(0.0, abs=0.05)
    # Steady wind from the east is leant against.
    assert math.tan(state.bank_rad) * GRAVITY_M_S2 == pytest.approx(
        0.8 * GRAVITY_M_S2 * math.tan(LIMITS.max_bank_rad) / LIMITS.fastest_m_s * wind_m_s, abs=0.05
    )


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("wind_m_s", [0.0, 6.0])
def test_a_mission_is_flown_from_take_off_to_disarm(flavour: Flavour, wind_m_s: float) -> None:
    """Straight up, lines within a metre, corners within their radius, an arc, straight down, disarmed."""
    arc = arc_waypoints(300.0, 350.0, 50.0, -90.0, 180.0, 30.0, 60.0)[1:]
    body = [waypoint(0.0, 300.0, 60.0), waypoint(300.0, 300.0, 60.0), *arc, LAND]
    s = taking_off(flavour, body, wind_m_s=wind_m_s, wind_from_deg=300.0)
    assert mode(s) == ("AUTO" if flavour is Flavour.ARDUPILOT else "AUTO.MISSION")
    s.fly_until_disarmed(300.0)
    first = 1 if flavour is Flavour.ARDUPILOT else 0
    assert s.reached() == list(range(first, first + 1 + len(body)))
    rising = [state for state in s.track if state.altitude_m < HOME.altitude_m + 55.0 and state.time_s < 15.0]
    assert max(math.hypot(*here(state)) for state in rising) < 1.0
    turned = next(state.time_s for state in s.track if here(state)[0] > 290.0)
    for state in s.track:
        east_m, north_m = here(state)
        assert state.ground_speed_m_s <= SPEED_M_S + 0.5
        if east_m > 20.0 and state.time_s < turned:
            assert north_m == pytest.approx(300.0, abs=0.6)
        if east_m > 302.0:
            # The chords of 30 degrees lie 1.7 m inside the arc, corners are cut by 2 m at most.
            assert -4.0 < math.dist((east_m, north_m), (300.0, 350.0)) - 50.0 < 1.0
    nearest_m = min(math.dist(here(state), (0.0, 300.0)) for state in s.track)
    assert nearest_m < 2.1
    assert math.hypot(*here(s.track[-1])) < 0.5
    assert s.track[-1].on_ground
    falling = [state.climb_m_s for state in s.track if state.altitude_m < HOME.altitude_m + 5.0][-40:]
    assert min(falling) > -1.0
    assert "Landed, throttle disarmed" in s.texts()


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_delay_at_a_waypoint_is_waited_there(flavour: Flavour) -> None:
    """Param 1 of a waypoint and NAV_DELAY: it stands still so long, then goes on."""
    body = [
        item(Command.NAV_WAYPOINT, place_at(0.0, 100.0, HOME.altitude_m + 60.0), (7.0,)),
        waypoint(50.0, 100.0, 60.0),
        item(Command.NAV_DELAY, None, (9.0,)),
        LAND,
    ]
    s = taking_off(flavour, body)
    s.fly_until_disarmed(200.0)
    for place, seconds in (((0.0, 100.0), 7.0), ((50.0, 100.0), 9.0)):
        still = [a.time_s for a in s.track if a.ground_speed_m_s < 0.5 and math.dist(here(a), place) < 2.0]
        assert seconds - 2.5 < still[-1] - still[0] < seconds + 4.0


def test_copter_pauses_within_auto_and_goes_on() -> None:
    """DO_PAUSE_CONTINUE: it brakes on its line, says AUTO and paused, and flies on to the same waypoint."""
    s = taking_off(Flavour.ARDUPILOT, [waypoint(0.0, 400.0, 60.0), LAND])
    s.fly(30.0)
    assert s.aircraft.state.ground_speed_m_s > 5.0
    assert s.command(Command.DO_PAUSE_CONTINUE, 0.0) == 0
    s.fly(20.0)
    stood = here(s.aircraft.state)
    assert s.aircraft.state.ground_speed_m_s < 0.1
    assert mode(s) == "AUTO"
    current = s.aircraft.message("MISSION_CURRENT")
    assert current is not None
    assert current.integer("mission_state") == 4
    assert abs(stood[0]) < 0.5
    assert 0.0 < stood[1] < 400.0
    assert s.command(Command.DO_PAUSE_CONTINUE, 1.0) == 0
    s.fly_until_disarmed(300.0)
    assert s.reached() == [1, 2, 3]
    assert s.command(Command.DO_PAUSE_CONTINUE, 0.0) == 2


@pytest.mark.parametrize(
    ("flavour", "pause", "told", "resume"),
    [
        (Flavour.ARDUPILOT, (1.0, 17.0), "BRAKE", (1.0, 3.0)),
        (Flavour.ARDUPILOT, (1.0, 5.0), "LOITER", (1.0, 3.0)),
        (Flavour.PX4, (1.0, 4.0, 3.0), "AUTO.LOITER", (1.0, 4.0, 4.0)),
    ],
)
def test_another_mode_holds_and_the_mission_mode_resumes(
    flavour: Flavour, pause: tuple[float, ...], told: str, resume: tuple[float, ...]
) -> None:
    """A holding mode stops it in the air, the mission mode goes on at the same item."""
    s = taking_off(flavour, [waypoint(0.0, 400.0, 60.0), LAND])
    s.fly(30.0)
    current = s.aircraft.pilot.current
    assert s.command(Command.DO_SET_MODE, *pause) == 0
    assert mode(s) == told
    s.fly(20.0)
    assert s.aircraft.state.ground_speed_m_s < 0.1
    assert s.command(Command.DO_SET_MODE, *resume) == 0
    assert s.aircraft.pilot.current == current
    s.fly_until_disarmed(300.0)
    assert math.hypot(*here(s.track[-1])) < 0.5


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_return_climbs_comes_home_and_lands(flavour: Flavour) -> None:
    """RTL in the mission: up to the return altitude, home, down, disarmed."""
    s = taking_off(flavour, [waypoint(150.0, 100.0, 60.0), item(Command.NAV_RETURN_TO_LAUNCH)])
    s.fly_until_disarmed(200.0)
    assert max(state.altitude_m for state in s.track) == pytest.approx(HOME.altitude_m + 80.0, abs=1.0)
    assert math.hypot(*here(s.track[-1])) < 0.5
    assert s.aircraft.mission_complete


def test_a_mission_without_an_end_is_waited_out() -> None:
    """ArduCopter stays in AUTO over its last waypoint, PX4 changes to AUTO.LOITER."""
    for flavour, told in ((Flavour.ARDUPILOT, "AUTO"), (Flavour.PX4, "AUTO.LOITER")):
        s = taking_off(flavour, [waypoint(0.0, 100.0, 60.0)])
        s.fly(60.0)
        assert mode(s) == told
        assert s.aircraft.mission_complete
        assert math.dist(here(s.aircraft.state), (0.0, 100.0)) < 2.5
        assert s.command(Command.NAV_LAND) == 0
        s.fly_until_disarmed(60.0)


def test_copter_waits_for_the_order_to_start() -> None:
    """AUTO alone does not lift it: MISSION_START does."""
    s = taking_off(Flavour.ARDUPILOT, [LAND])
    s.fly_until_disarmed(100.0)
    assert s.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
    assert s.command(Command.DO_SET_MODE, 1.0, 3.0) == 0
    s.fly(5.0)
    assert s.aircraft.state.on_ground
    assert s.command(Command.MISSION_START) == 0
    s.fly(5.0)
    assert not s.aircraft.state.on_ground


def test_turns_are_flown_round_their_place() -> None:
    """LOITER_TURNS of ArduCopter: twice round at its radius."""
    turns = item(Command.NAV_LOITER_TURNS, place_at(0.0, 100.0, HOME.altitude_m + 60.0), (2.0, 0.0, 25.0))
    s = taking_off(Flavour.ARDUPILOT, [turns, LAND])
    s.fly_until_disarmed(300.0)
    round_s = [a.time_s for a in s.track if abs(math.dist(here(a), (0.0, 100.0)) - 25.0) < 1.0]
    # sqrt(2.5 m/s2 x 25 m) = 7.9 m/s
    assert round_s[-1] - round_s[0] == pytest.approx(2.0 * 2.0 * math.pi * 25.0 / 7.9, rel=0.15)
