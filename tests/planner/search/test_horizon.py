"""The receding horizon on stored energy, in the paper's own order."""

import math

import numpy as np
import pytest
from shapely.geometry import LineString

from planner.search.horizon import VARIANTS, Variant, energy_horizon
from planner.search.paper_case import HEADING_RAD, paper_case

TURNS_S = (4.0, 6.0, 8.0)


@pytest.fixture(scope="module")
def flown():
    """Every variant at some turn durations."""
    case = paper_case()
    return {
        name: [energy_horizon(case, HEADING_RAD, variant, turn_s) for turn_s in TURNS_S]
        for name, variant in VARIANTS.items()
    }


def test_the_variants_stand_in_the_paper_s_order(flown):
    """Deciding sees more than not, a range of turn rates more than three, energy ends nearer than time."""
    seen = {name: np.mean([each.seen_m2 for each in flights]) for name, flights in flown.items()}
    off = {name: np.mean([each.exit_off_m for each in flights]) for name, flights in flown.items()}
    assert seen["energy-horizon"] > seen["energy-horizon-no-decision"]
    assert seen["energy-horizon"] > seen["energy-horizon-discrete"]
    assert off["energy-horizon"] < 1.0 < off["energy-horizon-time"]


def test_energy_is_used_and_not_more(flown):
    """No variant uses more than is stored; by energy all of it is, and time is what was meant."""
    case = paper_case()
    for name, flights in flown.items():
        for each in flights:
            assert each.energy_j <= case.glider.energy_j * (1.0 + 1e-9)
            straight_j = LineString(each.points).length / case.glider.airspeed_m_s * case.glider.power_w(0.0)
            assert each.energy_j >= 0.999 * straight_j
            if name == "energy-horizon":
                assert each.energy_j == pytest.approx(case.glider.energy_j)
                assert each.duration_s == pytest.approx(each.meant_s)
            if name == "energy-horizon-time":
                assert each.duration_s < each.meant_s


def test_turns_keep_the_load_factor(flown):
    """Between vertices no line turns faster than n = 1.5 allows."""
    glider = paper_case().glider
    for each in (flight for flights in flown.values() for flight in flights):
        steps = np.diff(each.points, axis=0)
        lengths = np.hypot(*steps.T)
        kept = lengths > 0.5
        angles = np.arctan2(steps[kept, 1], steps[kept, 0])
        turned = np.abs((np.diff(angles) + math.pi) % math.tau - math.pi)
        between_s = (lengths[kept][1:] + lengths[kept][:-1]) / 2.0 / glider.airspeed_m_s
        assert (turned <= glider.max_turn_rad_s * between_s * 1.02 + 1e-6).all()


def test_its_ground_is_the_union_of_discs(flown):
    """What it says to have seen is what shapely says of its line."""
    case = paper_case()
    (each, *_) = flown["energy-horizon"]
    seen = LineString(each.points).buffer(case.reach_m, quad_segs=64).intersection(case.ground).area
    assert each.seen_m2 == pytest.approx(seen, rel=1e-3)


def test_a_variant_is_its_features():
    """The names are those of the features left out."""
    assert VARIANTS["energy-horizon"] == Variant(continuous=True, decision=True, energy=True)
    assert not VARIANTS["energy-horizon-discrete"].continuous
    assert not VARIANTS["energy-horizon-no-decision"].decision
    assert not VARIANTS["energy-horizon-time"].energy
