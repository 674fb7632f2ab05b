"""Parameters judged by what a mission needs: each rule speaks when it must and is silent when all is well."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from pyproj import Geod

from mavlink.dialects import Autopilot
from mavlink.encoding.encode import encode
from mavlink.encoding.payload import (
    ActuatorPayload,
    CameraPayload,
    RelayPayload,
    ServoPayload,
    parse_payload,
)
from mavlink.rules.firmware import still_to_ask
from mavlink.rules.table import (
    RULES,
    Needs,
    judge_parameters,
    names_to_read,
    needs_of,
    unanswered,
)
from mavlink.wire.items import Command
from tests.mavlink.cameras import with_photos
from tests.mavlink.plans import make_plan

PLANE = Needs(22.4, 100.0, None, CameraPayload(25.0), frozenset({22, 16, 21, 189}), True, 500.0, 4000.0)
SERVO9 = {"SERVO9_FUNCTION": 10.0}
GOOD: dict[Autopilot, dict[str, float]] = {
    "ardupilot": {
        "WP_RADIUS": 50.0,
        "NAVL1_PERIOD": 10.0,
        "AIRSPEED_CRUISE": 22.0,
        "ROLL_LIMIT_DEG": 45.0,
        "WP_LOITER_RAD": -100.0,
        "RTL_AUTOLAND": 2.0,
        "RTL_ALTITUDE": 100.0,
        "TECS_CLMB_MAX": 5.0,
        "TECS_SINK_MAX": 5.0,
        "FENCE_ENABLE": 1.0,
        "FENCE_TYPE": 7.0,
        "FENCE_ACTION": 1.0,
        "FENCE_ALT_MAX": 600.0,
        "FENCE_RADIUS": 5000.0,
        "CAM1_TYPE": 1.0,
        "SERVO1_FUNCTION": 4.0,
        "SERVO9_FUNCTION": 10.0,
    },
    "px4": {
        "NAV_ACC_RAD": 30.0,
        "NPFG_PERIOD": 10.0,
        "NPFG_DAMPING": 0.7,
        "NPFG_SW_DST_MLT": 0.32,
        "NAV_LOITER_RAD": 80.0,
        "FW_AIRSPD_TRIM": 22.4,
        "FW_R_LIM": 50.0,
        "FW_T_CLMB_R_SP": 3.0,
        "FW_T_CLMB_MAX": 5.0,
        "FW_T_SINK_R_SP": 2.0,
        "FW_T_SINK_MAX": 5.0,
        "RTL_RETURN_ALT": 60.0,
        "FW_LND_ANG": 5.0,
        "MIS_TKO_LAND_REQ": 2.0,
        "GF_ACTION": 3.0,
        "TRIG_MODE": 4.0,
        "COM_DISARM_PRFLT": 10.0,
        "COM_DISARM_LAND": 2.0,
    },
}


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_all_well_is_no_finding(autopilot: Autopilot) -> None:
    """Values as advised draw nothing, and every one of them is read."""
    values = GOOD[autopilot]
    assert judge_parameters(autopilot, "fixed_wing", PLANE, values) == ()
    assert set(values) <= set(names_to_read(autopilot, "fixed_wing", PLANE))


@pytest.mark.parametrize(
    ("autopilot", "name", "value", "severity"),
    [
        ("ardupilot", "WP_RADIUS", 90.0, "warning"),
        ("ardupilot", "NAVL1_PERIOD", 20.0, "warning"),
        ("ardupilot", "AIRSPEED_CRUISE", 15.0, "warning"),
        ("ardupilot", "ROLL_LIMIT_DEG", 20.0, "error"),
        ("ardupilot", "RTL_AUTOLAND", 0.0, "error"),
        ("ardupilot", "FENCE_ENABLE", 0.0, "warning"),
        ("ardupilot", "FENCE_TYPE", 3.0, "warning"),
        ("ardupilot", "FENCE_ACTION", 0.0, "warning"),
        ("ardupilot", "CAM1_TYPE", 0.0, "error"),
        ("px4", "NAV_ACC_RAD", 80.0, "warning"),
        ("px4", "FW_AIRSPD_TRIM", 14.0, "warning"),
        ("px4", "NPFG_SW_DST_MLT", 0.6, "warning"),
        ("px4", "NAV_LOITER_RAD", 60.0, "warning"),
        ("ardupilot", "WP_LOITER_RAD", -60.0, "warning"),
        ("px4", "FW_R_LIM", 20.0, "error"),
        ("px4", "FW_LND_ANG", 2.0, "error"),
        ("px4", "GF_ACTION", 0.0, "warning"),
        ("px4", "TRIG_MODE", 0.0, "error"),
        ("px4", "COM_DISARM_PRFLT", 2.0, "warning"),
        ("px4", "COM_DISARM_LAND", -1.0, "warning"),
    ],
)
def test_each_wrong_value_is_named(autopilot: Autopilot, name: str, value: float, severity: str) -> None:
    """One value off draws one finding: that parameter, that value, and advice that would be accepted."""
    values = GOOD[autopilot] | {name: value}
    (finding,) = judge_parameters(autopilot, "fixed_wing", PLANE, values)
    assert (finding.name, finding.value, finding.severity) == (name, value, severity)
    assert finding.advised is not None
    assert name in str(finding)
    better = values | {name: finding.advised}
    assert judge_parameters(autopilot, "fixed_wing", PLANE, better) == ()


def test_what_was_not_read_is_not_judged() -> None:
    """No value, no finding."""
    for autopilot, kind in RULES:
        assert judge_parameters(autopilot, kind, PLANE, {}) == ()


@pytest.mark.parametrize(
    ("needs", "values", "wrong"),
    [
        (PLANE, {"SERVO1_FUNCTION": 4.0, "SERVO9_FUNCTION": 0.0}, "SERVO1_FUNCTION"),
        (replace(PLANE, payload=ServoPayload(9)), {"SERVO9_FUNCTION": 10.0}, "SERVO9_FUNCTION"),
        (replace(PLANE, payload=ServoPayload(9)), {"SERVO9_FUNCTION": 0.0}, None),
        (replace(PLANE, payload=RelayPayload(2)), {"RELAY3_FUNCTION": 0.0}, "RELAY3_FUNCTION"),
        (replace(PLANE, payload=RelayPayload(2)), {"RELAY3_FUNCTION": 1.0}, None),
        (replace(PLANE, payload=RelayPayload(2)), {"CAM1_TYPE": 0.0}, None),
    ],
)
def test_ardupilots_outputs_follow_the_payload(
    needs: Needs, values: dict[str, float], wrong: str | None
) -> None:
    """The output that switches the chosen payload is looked at, and only that."""
    found = judge_parameters("ardupilot", "fixed_wing", needs, values)
    assert [finding.name for finding in found] == ([] if wrong is None else [wrong])


PHOTOS = replace(PLANE, payload=parse_payload("trigger:distance=25"), photo_s=1.1)
VIDEO = replace(PLANE, payload=parse_payload("trigger:video"))
BOTH = replace(PHOTOS, payload=parse_payload("relay:2+trigger:distance=25"))


@pytest.mark.parametrize(
    ("autopilot", "needs", "values", "wrong"),
    [
        ("ardupilot", PHOTOS, {"CAM1_TYPE": 0.0}, "CAM1_TYPE"),
        ("ardupilot", PHOTOS, {"CAM1_TYPE": 1.0, "SERVO9_FUNCTION": 0.0}, "SERVO9_FUNCTION"),
        ("ardupilot", PHOTOS, {"CAM1_TYPE": 2.0, "SERVO9_FUNCTION": 0.0}, None),
        ("ardupilot", PHOTOS, {"CAM1_INTRVAL_MIN": 1.0}, None),
        ("ardupilot", PHOTOS, {"CAM1_INTRVAL_MIN": 1.2}, "CAM1_INTRVAL_MIN"),
        ("ardupilot", PHOTOS, {"CAM1_TRIGG_DIST": 20.0}, "CAM1_TRIGG_DIST"),
        ("ardupilot", PHOTOS, {"CAM_AUTO_ONLY": 0.0}, "CAM_AUTO_ONLY"),
        ("ardupilot", PHOTOS, {"CAM_MAX_ROLL": 0.0}, None),
        ("ardupilot", PHOTOS, {"CAM_MAX_ROLL": 5.0}, "CAM_MAX_ROLL"),
        ("ardupilot", VIDEO, {"CAM1_TYPE": 2.0}, "CAM1_TYPE"),
        ("ardupilot", VIDEO, {"CAM1_TYPE": 6.0, "CAM_AUTO_ONLY": 0.0}, None),
        ("ardupilot", BOTH, {"RELAY3_FUNCTION": 0.0}, "RELAY3_FUNCTION"),
        ("ardupilot", BOTH, {"CAM1_TYPE": 0.0}, "CAM1_TYPE"),
        ("px4", PHOTOS, {"TRIG_MODE": 1.0}, "TRIG_MODE"),
        ("px4", VIDEO, {"TRIG_MODE": 0.0}, None),
        ("px4", PHOTOS, {"TRIG_MIN_INTERVA": 1.0}, None),
        ("px4", PHOTOS, {"TRIG_MIN_INTERVA": 1500.0}, "TRIG_MIN_INTERVA"),
        ("px4", PHOTOS, {"TRIG_INTERFACE": 3.0, "PWM_AUX_FUNC1": 0.0}, None),
        ("px4", PHOTOS, {"TRIG_INTERFACE": 4.0, "PWM_AUX_FUNC1": 0.0}, "TRIG_INTERFACE"),
        ("px4", PHOTOS, {"TRIG_INTERFACE": 1.0, "PWM_AUX_FUNC1": 2000.0}, None),
        ("px4", PHOTOS, {"CAM_CAP_FBACK": 1.0, "PWM_AUX_FUNC1": 2000.0}, "CAM_CAP_FBACK"),
        ("px4", PHOTOS, {"CAM_CAP_FBACK": 1.0, "PWM_AUX_FUNC1": 2032.0}, None),
    ],
)
def test_cameras_need_a_driver_an_output_and_time(
    autopilot: Autopilot, needs: Needs, values: dict[str, float], wrong: str | None
) -> None:
    """Each by what the plan orders of the camera; all that is looked at is asked for."""
    found = judge_parameters(autopilot, "fixed_wing", needs, values)
    assert [finding.name for finding in found] == ([] if wrong is None else [wrong])
    if wrong is not None:
        assert set(values) <= set(names_to_read(autopilot, "fixed_wing", needs))
        for finding in found:
            if finding.advised is not None:
                better = values | {wrong: finding.advised}
                assert judge_parameters(autopilot, "fixed_wing", needs, better) == ()


def test_the_shortest_time_between_photos_is_the_plans() -> None:
    """By what is published of each pass."""
    plan = with_photos(make_plan())
    needs = needs_of(plan, encode(plan), parse_payload("trigger:distance=41"))
    assert needs.photo_s == pytest.approx(min(photos.interval_s or 0.0 for photos in plan.photos))
    assert needs_of(make_plan(), encode(make_plan()), RelayPayload()).photo_s is None


@pytest.mark.parametrize(("function", "wrong"), [(302.0, False), (402.0, True), (301.0, True)])
def test_px4s_actuator_needs_an_output(function: float, wrong: bool) -> None:
    """One output must carry the function of the actuator that switches the sensor."""
    needs = replace(PLANE, payload=ActuatorPayload(2))
    found = judge_parameters("px4", "fixed_wing", needs, {"PWM_MAIN_FUNC1": 101.0, "PWM_AUX_FUNC1": function})
    assert bool(found) is wrong


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (302.0, None),
        (0.0, "output AUX 3 does not follow actuator set 2"),
        (304.0, "plan with aux:3:4, or change the vehicle"),
        (101.0, "in use for something else"),
    ],
)
def test_px4s_named_output_must_follow_its_actuator(function: float, words: str | None) -> None:
    """Whatever other outputs follow; the finding advises the function, and says what is there instead."""
    needs = replace(PLANE, payload=parse_payload("aux:3:2"))
    assert [n for n in names_to_read("px4", "fixed_wing", needs) if n.startswith("PWM")] == ["PWM_AUX_FUNC3"]
    values = {"PWM_AUX_FUNC3": function, "PWM_MAIN_FUNC1": 302.0}
    found = judge_parameters("px4", "fixed_wing", needs, values)
    assert bool(found) is (words is not None)
    for finding in found:
        assert (finding.name, finding.advised, finding.severity) == ("PWM_AUX_FUNC3", 302.0, "error")
        assert words in finding.reason
        assert judge_parameters("px4", "fixed_wing", needs, {**values, "PWM_AUX_FUNC3": 302.0}) == ()


@pytest.mark.parametrize(
    ("name", "value", "severity"),
    [("VT_ARSP_TRANS", 25.0, "warning"), ("VT_FW_MIN_ALT", 50.0, "error"), ("VT_B_DEC_MSS", 1.0, "warning")],
)
def test_px4s_vtols_are_judged_by_their_transitions(name: str, value: float, severity: str) -> None:
    """On wings as a fixed wing, but for the slope of a landing it does not make; then by both transitions."""
    needs = replace(PLANE, commands=frozenset({84, 16, 85, 189}))
    good = GOOD["px4"] | {"VT_ARSP_TRANS": 10.0, "VT_FW_MIN_ALT": 0.0, "VT_B_DEC_MSS": 2.0, "FW_LND_ANG": 2.0}
    assert judge_parameters("px4", "vtol", needs, good) == ()
    assert name not in names_to_read("px4", "fixed_wing", needs)
    (finding,) = judge_parameters("px4", "vtol", needs, good | {name: value})
    assert (finding.name, finding.severity) == (name, severity)
    assert finding.advised is not None
    assert judge_parameters("px4", "vtol", needs, good | {name: finding.advised}) == ()


@pytest.mark.parametrize(("name", "value"), [("Q_ENABLE", 0.0), ("Q_TRANS_DECEL", 0.9)])
def test_quadplanes_are_judged_as_planes_that_hover(name: str, value: float) -> None:
    """With rotors in use, and braking hard enough for ArduPlane to arm with the approach there is."""
    needs = replace(PLANE, commands=frozenset({84, 16, 85}))
    good = GOOD["ardupilot"] | {"Q_ENABLE": 1.0, "Q_TRANS_DECEL": 2.0}
    assert judge_parameters("ardupilot", "vtol", needs, good) == ()
    (finding,) = judge_parameters("ardupilot", "vtol", needs, good | {name: value})
    assert (finding.name, finding.severity) == (name, "error")
    assert finding.advised is not None
    assert judge_parameters("ardupilot", "vtol", needs, good | {name: finding.advised}) == ()


@pytest.mark.parametrize(
    ("required", "commands", "flies"),
    [
        (2, {22, 16, 20}, False),  # RTL is no landing
        (2, {22, 16, 21}, True),
        (1, {16, 21}, False),
        (3, {22, 16}, False),
        (4, {16}, True),
        (4, {22, 16}, False),
        (0, {16}, True),
    ],
)
def test_px4s_required_items(required: int, commands: set[int], flies: bool) -> None:
    """MIS_TKO_LAND_REQ is compared with the items the mission has."""
    needs = replace(PLANE, commands=frozenset(commands))
    found = judge_parameters("px4", "fixed_wing", needs, {"MIS_TKO_LAND_REQ": float(required)})
    assert (found == ()) is flies


def test_the_period_follows_the_straight_left_for_settling() -> None:
    """Little straight before the passes asks for a shorter period, at no more than the turns allow."""
    wide = replace(PLANE, turn_radius_m=200.0)
    near = replace(wide, settle_m=100.0)
    (far_finding,) = judge_parameters("ardupilot", "fixed_wing", wide, {"NAVL1_PERIOD": 40.0})
    (near_finding,) = judge_parameters("ardupilot", "fixed_wing", near, {"NAVL1_PERIOD": 40.0})
    assert far_finding.advised == 20.0
    assert near_finding.advised == pytest.approx(math.floor(15.0 * 100.0 / 130.0))
    assert "100 m of straight" in near_finding.reason


def test_needs_come_from_plan_and_mission() -> None:
    """Speed and radius are the plan's, commands the mission's; a relay on PX4 is the actuator it becomes."""
    plan = make_plan(autopilot="px4")
    mission = encode(plan)
    needs = needs_of(plan, mission, RelayPayload(0), 150.0)
    assert (needs.airspeed_m_s, needs.settle_m) == (plan.vehicles[0].airspeed_m_s, 150.0)
    assert needs.payload == ActuatorPayload(1)
    assert Command.NAV_WAYPOINT in needs.commands
    assert needs.fence == bool(mission.fence)


@pytest.mark.parametrize(
    ("modern", "older", "unit", "wrong"),
    [("ROLL_LIMIT_DEG", "LIM_ROLL_CD", 100.0, 20.0), ("AIRSPEED_CRUISE", "TRIM_ARSPD_CM", 100.0, 15.0)],
)
def test_older_names_are_judged_in_their_own_units(
    modern: str, older: str, unit: float, wrong: float
) -> None:
    """Asked for where the new name is not answered; value and advice are in their hundredths."""
    values = {name: value for name, value in GOOD["ardupilot"].items() if name != modern}
    names = names_to_read("ardupilot", "fixed_wing", PLANE)
    assert still_to_ask(names, names, values) == (older,)
    assert still_to_ask(names, names, GOOD["ardupilot"]) == ()
    assert modern in unanswered(names, values)
    assert modern not in unanswered(names, {**values, older: 1.0})
    (finding,) = judge_parameters("ardupilot", "fixed_wing", PLANE, values | {older: wrong * unit})
    assert (finding.name, finding.value) == (older, wrong * unit)
    assert finding.advised is not None
    assert judge_parameters("ardupilot", "fixed_wing", PLANE, values | {older: finding.advised}) == ()


@pytest.mark.parametrize(
    ("speed_m_s", "radius_m", "cut"), [(14.0, 63.0, False), (14.0, 40.0, True), (30.0, 100.0, True)]
)
def test_px4s_acceptance_distance_is_a_product(speed_m_s: float, radius_m: float, cut: bool) -> None:
    """0.32 · speed · 10 s · 0.7, about 31 m at 14 m/s whatever NAV_ACC_RAD says, against half the radius."""
    needs = replace(PLANE, airspeed_m_s=speed_m_s, turn_radius_m=radius_m)
    values = {"NPFG_SW_DST_MLT": 0.32, "NPFG_PERIOD": 10.0, "NPFG_DAMPING": 0.7}
    found = judge_parameters("px4", "fixed_wing", needs, values)
    assert [finding.name for finding in found] == (["NPFG_SW_DST_MLT"] if cut else [])
    assert judge_parameters("px4", "fixed_wing", needs, {"NPFG_SW_DST_MLT": 1.0}) == ()
    if cut:
        assert f"{0.32 * speed_m_s * 7.0:.0f} m away" in found[0].reason


def test_px4s_long_period_both_wanders_and_cuts() -> None:
    """Twice the period holds lines worse and doubles the distance at which waypoints count as reached."""
    found = judge_parameters("px4", "fixed_wing", PLANE, GOOD["px4"] | {"NPFG_PERIOD": 20.0})
    assert {finding.name: finding.advised for finding in found} == {
        "NPFG_PERIOD": 10.0,
        "NPFG_SW_DST_MLT": pytest.approx(0.15),
    }


@pytest.mark.parametrize(("kinds", "advised"), [(0.0, 4.0), (1.0, 5.0), (3.0, 7.0), (8.0, 12.0)])
def test_a_fence_type_is_advised_with_the_kinds_in_force(kinds: float, advised: float) -> None:
    """ArduPilot's own circle of 300 m and height of 100 m are not put in force by following the advice."""
    found = judge_parameters("ardupilot", "fixed_wing", PLANE, GOOD["ardupilot"] | {"FENCE_TYPE": kinds})
    assert [(finding.name, finding.value, finding.advised) for finding in found] == [
        ("FENCE_TYPE", kinds, advised)
    ]


@pytest.mark.parametrize(
    ("name", "limit", "kind", "advised"),
    [("FENCE_ALT_MAX", 100.0, 1, 520.0), ("FENCE_RADIUS", 300.0, 2, 4020.0)],
)
def test_a_fence_of_the_vehicles_own_is_not_breached(
    name: str, limit: float, kind: int, advised: float
) -> None:
    """A height or circle that the mission goes beyond is told where its kind counts: an error if it is on."""
    for kinds, enabled, severity in ((7, 1, "error"), (7 - kind, 1, None), (7, 0, "warning")):
        values = GOOD["ardupilot"] | {name: limit, "FENCE_TYPE": float(kinds), "FENCE_ENABLE": float(enabled)}
        for vehicle in ("fixed_wing", "multirotor"):
            found = [f for f in judge_parameters("ardupilot", vehicle, PLANE, values) if f.name == name]
            assert [(f.value, f.advised, f.severity) for f in found] == (
                [] if severity is None else [(limit, advised, severity)]
            )


def test_how_high_and_far_a_mission_goes_is_read_from_its_items() -> None:
    """The highest and the farthest place above and from home, by an independent geodesic."""
    plan = make_plan()
    mission = encode(plan, autopilot="ardupilot")
    needs = needs_of(plan, mission, RelayPayload(0))
    flown = [item for item in mission.mission[1:] if item.command == 16]
    far = max(Geod(ellps="WGS84").inv(*mission.home, item.y / 1e7, item.x / 1e7)[2] for item in flown)
    assert needs.farthest_m >= far - 1e-6
    assert needs.farthest_m < far + 2000.0
    assert needs.highest_m == pytest.approx(max(item.z for item in flown), abs=1.0)
