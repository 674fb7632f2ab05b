"""What a search refuses: each by feature, rule and fix."""

import numpy as np
import pytest
from shapely.affinity import rotate

from planner.airspace.terrain import Terrain
from planner.errors import InfeasibleError, ScenarioError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.tasks.worth import worth_of
from planner.validate import findings, read_valid
from tests.planner.search.searches import LAT_DEG, LON_DEG, RADAR, WING, document, feature, lonlat, rectangle


def rules(asked, terrains=None):
    """Rules of the errors, by feature."""
    return {(f.feature, f.rule) for f in findings(asked, terrains) if f.severity == "error"}


def raster(values, lon_deg=LON_DEG, lat_deg=LAT_DEG):
    """A raster of half-kilometre cells from a corner on."""
    return Terrain("worth", np.array(values, dtype=np.float32), (0.006, 0.0, lon_deg, 0.0, 0.005, lat_deg))


WEST = (0, 0, 500, 500)
GROUND = rectangle("roi", 500, 400, 1100, 800, name="G")
BARRED = rectangle("no_fly", 500, 400, 1100, 800, name="Z")


def walls(west, south, east, north, thick=80):
    """Four zones round a yard."""
    return [
        rectangle("no_fly", west, south, east, south + thick, name="S"),
        rectangle("no_fly", west, north - thick, east, north, name="N"),
        rectangle("no_fly", west, south, west + thick, north, name="W"),
        rectangle("no_fly", east - thick, south, east, north, name="Z"),
    ]


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        (
            document(
                rectangle("no_fly", 300, 300, 1400, 1100), rectangle("roi", 500, 400, 1100, 800, name="R")
            ),
            ("R", "blocked"),
        ),
        (document(BARRED, GROUND), ("G", "blocked")),
        (document(BARRED, GROUND, sensor=RADAR), ("G", "blocked")),
        (
            document(*walls(200, 200, 1000, 800), feature("end", "Point", lonlat(600, 500), name="E")),
            ("E", "hard-zone"),
        ),
        (
            document(*walls(300, 300, 1150, 880), rectangle("roi", 480, 480, 900, 650, name="R")),
            ("R", "hard-zone"),
        ),
        (document(vehicle=WING | {"energy_wh": 3}), ("uav", "energy")),
        (document(vehicle=WING | {"energy_wh": 3, "reserve": 1.5}), ("vehicle uav", "out-of-range")),
        (document(altitude_m=100, max_height_m=80), ("area", "above-ceiling")),
        (document(rectangle("importance", *WEST, name="I", score=-1)), ("I", "out-of-range")),
        (document(rectangle("importance", *WEST, name="I", score=float("nan"))), ("I", "not-finite")),
        (document(rectangle("importance", *WEST, score=0)), ("scenario", "nothing-important")),
        (document(importance_raster="nowhere"), ("scenario", "unknown-raster")),
        (document(rectangle("roi", *WEST, name="R", revisits=2)), ("R", "not-supported")),
    ],
    ids=[
        "blocked",
        "barred",
        "barred-to-radar",
        "walled-in",
        "walled-off",
        "energy",
        "reserve",
        "ceiling",
        "negative",
        "nan",
        "zero",
        "raster",
        "revisits",
    ],
)
def test_what_no_search_can_keep_is_refused(asked, found):
    """Each is an error that names the feature and the rule."""
    assert found in rules(asked)


def yard(wide, gate):
    """Four walls round a yard from 600, 400 on, so wide, with a gate in the east."""
    until = 400 + wide
    return [
        rectangle("no_fly", 540, 340, 660 + wide, 400, name="S"),
        rectangle("no_fly", 540, until, 660 + wide, until + 60, name="N"),
        rectangle("no_fly", 540, 340, 600, until + 60, name="W"),
        rectangle("no_fly", 600 + wide, 340, 660 + wide, until - gate, name="E"),
    ]


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        (
            document(
                *walls(300, 300, 1150, 880), rectangle("importance", 480, 480, 900, 650, score=1.0),
                method={"search": "spiral"}, vehicle=WING | {"energy_wh": 10},
            ),
            ("area", "hard-zone", "S, N, W, Z in between"),
        ),
        (
            document(
                *yard(300, 30), rectangle("roi", 100, 500, 200, 560, name="R"),
                feature("end", "Point", lonlat(750, 550), name="home"), clearance_m=5,
                method={"search": "parallel"},
            ),
            ("W", "hard-zone", "are flown inside W"),
        ),
        (
            document(
                rectangle("importance", 900, 650, 1150, 850, score=1.0), method={"search": "parallel"},
                vehicle=WING | {"energy_wh": 4.5},
            ),
            ("uav", "energy", "Wh short, "),
        ),
    ],
    ids=["all-that-counts-walled-off", "a-gate-too-near-to-climb", "all-that-counts-out-of-reach"],
)  # fmt: skip
def test_a_search_that_finds_nothing_or_leads_through_what_is_hard_is_refused(asked, found):
    """Where only planning shows it: no plan that sees other ground alone, none that breaks a zone."""
    feature_, rule, said = found
    with pytest.raises(InfeasibleError) as refused:
        make_plan(read_valid(asked))
    assert (refused.value.feature, refused.value.constraint) == (feature_, rule)
    assert said in refused.value.message


def test_ground_beyond_a_wall_is_told_and_the_rest_searched():
    """A wall across the area: the part at the start is seen, of the other its share is said."""
    ground = rectangle("roi", 300, 100, 760, 300, name="R")
    wall = rectangle("no_fly", 500, 0, 560, 900, name="wall")
    asked = document(ground, wall, method={"search": "parallel"}, vehicle=WING | {"energy_wh": 10})
    plan = make_plan(read_valid(asked))
    assert plan.hard_violations == ()
    said = next(each for each in plan.warnings if "no flight leads" in each)
    assert "wall in between" in said
    assert said.startswith("R: no flight leads to 36.5% of the ground")
    assert 0.2 < plan.metrics.coverage["R"] < 0.5


def test_what_blocks_a_search_is_named():
    """The zones that leave no pass, most of it first, and not one that is far away."""
    over = document(
        rectangle("no_fly", 450, 300, 1400, 1100, name="wide"),
        rectangle("obstacle", 300, 380, 480, 820, name="mast", height_m=300),
        rectangle("no_fly", 60, 700, 100, 760, name="far"),
        rectangle("roi", 420, 400, 1100, 800, name="R"),
    )
    (said,) = [f.message for f in findings(over) if f.rule == "blocked"]
    assert "wide, mast" in said
    assert "far" not in said


def test_a_start_is_named_where_its_flight_has_no_room():
    """At the end of a narrow arm nobody comes down into a strong wind along it: the start is named."""
    asked = document(wind={"speed_m_s": 11, "from_deg": 90}, method={"search": "parallel"})
    arm = [(0, 480), (-1000, 480), (-1000, 420), (0, 420)]
    ring = [(0, 0), (1200, 0), (1200, 900), (0, 900), *arm, (0, 0)]
    asked["features"][0] = feature("area", "Polygon", [[lonlat(*corner) for corner in ring]])
    asked["features"][1] = feature("start", "Point", lonlat(-980.0, 450.0), name="pad")
    (said,) = [f for f in findings(asked) if f.severity == "error"]
    assert (said.feature, said.rule) == ("pad", "area")
    assert "no room" in said.message
    asked["features"][1] = feature("start", "Point", lonlat(600.0, 15.0), name="pad")
    assert rules(asked) == set()


KNOWN = feature("importance", "Point", lonlat(600, 450), score=1.0, spread_m=100.0, name="K")
DRIFT = {"speed_m_s": 0.5, "toward_deg": 90.0}


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        (document(KNOWN, search={"detection": 0.0}), ("search", "out-of-range")),
        (document(KNOWN, search={"detection": 1.2}), ("search", "out-of-range")),
        (document(KNOWN, search={"sweeps": 2}), ("search", "unknown-property")),
        (document(KNOWN, search=[]), ("scenario", "bad-value")),
        (document(KNOWN, search={"drift": {"speed_m_s": 1.0}}), ("drift", "missing-property")),
        (document(KNOWN, search={"drift": DRIFT | {"toward_deg": 400}}), ("drift", "out-of-range")),
        (document(search={"drift": DRIFT}), ("drift", "nothing-drifts")),
        (
            document(feature("importance", "Point", lonlat(0, 0), score=1.0, name="K")),
            ("K", "missing-property"),
        ),
        (document(rectangle("importance", *WEST, score=1, spread_m=5, name="I")), ("I", "unknown-property")),
        (
            document(KNOWN, search={"drift": DRIFT}, method={"search": "snyder2021"}),
            ("method", "not-supported"),
        ),
        (document(KNOWN, method={"search": "energy-horizon"}), ("method", "not-supported")),
        (
            document(search={"detection": 0.5}, method={"search": "energy-horizon"}),
            ("method", "not-supported"),
        ),
        (document(method={"search": "wiggle"}), ("method", "unknown-value")),
        (document(method={"routing": "li2018"}), ("method", "not-supported")),
        (document(method={"search": "spiral"}, task="collect"), ("method", "not-supported")),
    ],
)
def test_what_no_search_can_believe_is_refused(asked, found):
    """Each is an error that names the member and the rule, before anything is planned."""
    assert found in rules(asked)


def test_ground_of_what_drifts_is_where_it_may_be():
    """Without area and regions the ground reaches from where it was to where it may be in the end."""
    asked = document(KNOWN, search={"drift": DRIFT | {"elapsed_s": 1000.0}}, vehicle=WING | {"energy_wh": 30})
    asked["features"] = asked["features"][1:]
    scenario = read_valid(asked)
    (region,) = scenario.regions
    west, south, east, north = rotate(
        region.area, scenario.frame.turned_rad, origin=(0.0, 0.0), use_radians=True
    ).bounds
    usable_s = 30 * 0.8 * 3600 / 120
    assert east - west == pytest.approx(600.0 + 0.5 * usable_s, rel=0.01)
    assert north - south == pytest.approx(600.0, rel=0.01)
    asked["vehicles"] = [{k: v for k, v in WING.items() if k not in ("energy_wh", "power")}]
    assert ("scenario", "no-ground") in rules(asked)


def test_nothing_to_search_is_refused():
    """Without area, regions and importance there is no ground."""
    asked = document()
    asked["features"] = asked["features"][1:]
    assert ("scenario", "no-ground") in rules(asked)


def test_a_shortfall_is_told_in_energy_and_way():
    """A search that cannot come to its end says how many watt hours and metres are missing."""
    far = feature("end", "Point", lonlat(30_000.0, 0.0))
    asked = document(rectangle("roi", 0, 0, 1200, 900), far)
    asked["features"] = asked["features"][1:]
    with pytest.raises(ScenarioError) as caught:
        read_valid(asked)
    (finding,) = [f for f in caught.value.findings if f.severity == "error"]
    used, there, short, metres = (
        float(word) for word in finding.message.replace(",", " ").replace(":", " ").split() if _number(word)
    )
    assert used - there == pytest.approx(short, abs=0.2)
    # Of a constant 120 W at 16 m/s.
    assert metres == pytest.approx(short * 3600.0 / 120.0 * 16.0, rel=0.01)


CHARGED = {k: v for k, v in WING.items() if k != "energy_wh"} | {"voltage_v": 14.8}


@pytest.mark.parametrize(
    ("vehicle", "named"),
    [
        (WING | {"energy_wh": 3}, "energy_wh"),
        (CHARGED | {"charge_mah": 210}, "charge_mah"),
        (WING | {"max_range_m": 600}, "max_range_m"),
        (WING | {"max_flight_time_s": 60}, "max_flight_time_s"),
    ],
    ids=["energy", "charge", "range", "time"],
)
def test_what_is_said_to_do_does(vehicle, named):
    """With the least value that a refusal names the search is planned, and sees something."""
    asked = document(vehicle=vehicle)
    (short,) = [f for f in findings(asked) if f.severity == "error"]
    words = short.fix.replace(",", "").split()
    assert words[1] == named
    asked["vehicles"][0][named] = float(words[3])
    plan = make_plan(read_valid(asked))
    assert plan.violations == ()
    assert plan.metrics.area_seen_m2 > 0.0


def _number(word):
    return word.replace(".", "", 1).isdigit()


@pytest.mark.parametrize(
    ("terrain", "rule"),
    [
        (raster([[1.0, 2.0], [0.5, -3.0]]), "bad-score"),
        (raster([[1.0, 2.0], [0.5, 3.0]], lon_deg=LON_DEG + 1.0), "raster-outside"),
    ],
    ids=["negative", "outside"],
)
def test_rasters_of_no_use_are_refused(terrain, rule):
    """Negative importance, and a raster that lies elsewhere."""
    assert ("scenario", rule) in rules(document(importance_raster="worth"), {"worth": terrain})


def test_one_negative_value_is_found_however_fine_the_raster():
    """Cells of the ground are means of many values: one below 0 is refused all the same."""
    values = np.ones((1600, 1600), np.float32)
    values[800, 800] = -1.0
    step = 0.02 / 1600
    fine = Terrain("worth", values, (step, 0.0, LON_DEG - 0.002, 0.0, step, LAT_DEG - 0.002))
    assert ("scenario", "bad-score") in rules(document(importance_raster="worth"), {"worth": fine})


def test_a_raster_is_what_the_ground_is_worth():
    """Scores of the ground's cells are those between the raster's posts."""
    terrain = raster([[1.0, 1.0, 1.0, 1.0]] * 2 + [[5.0, 5.0, 5.0, 5.0]] * 2)
    scenario = read_scenario(document(importance_raster="worth"), {"worth": terrain})
    local = scenario.importance.raster
    places = scenario.frame.to_local([lonlat(600.0, 10.0), lonlat(600.0, 890.0)])
    columns, rows = ((places - (local.west_m, local.south_m)) // local.cell_m).astype(int).T
    south, north = local.scores[rows, columns]
    assert south == pytest.approx(1.0, abs=0.1)
    assert north > 3.0


def test_a_fine_raster_is_worth_its_mean():
    """A chessboard of squares finer than any cell: no cell misses what lies between."""
    rows, columns = np.indices((900, 900))
    board = (100.0 * ((rows + columns) % 2)).astype(np.float32)
    step = 0.02 / 900
    terrain = Terrain("worth", board, (step, 0.0, LON_DEG - 0.002, 0.0, step, LAT_DEG - 0.002))
    scenario = read_scenario(document(importance_raster="worth"), {"worth": terrain})
    (region,) = scenario.regions
    local = scenario.importance.raster
    assert local.scores.sum() * local.cell_m**2 == pytest.approx(50.0 * region.area.area, rel=0.02)
    coarse = worth_of(scenario, region.area, 40.0)
    inside = coarse.scores[2:-2, 2:-2]
    assert inside.min() > 40.0
    assert inside.max() < 60.0


def test_importance_is_no_terrain():
    """A raster sent as one of no heights is refused where it is to be flown over."""
    hills = Terrain("worth", np.ones((4, 4), np.float32), raster([[1.0, 1.0]] * 2).affine, None, "none")
    asked = document(terrain="worth", importance_raster="worth")
    assert ("scenario", "no-heights") in rules(asked, {"worth": hills})


@pytest.mark.parametrize(
    "family", ["parallel", "creeping", "spiral", "square", "sector", "importance", "snyder2021"]
)
def test_patterns_may_be_asked_for_by_name(family):
    """Each is accepted, another is named."""
    assert read_scenario(document(method={"search": family})).method.search == family
    assert ("method", "unknown-value") in rules(document(method={"search": "wander"}))
