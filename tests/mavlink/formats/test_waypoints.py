"""QGC WPL 110, read by pymavlink and by ourselves."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink import mavwp

from mavlink.dialects import Autopilot
from mavlink.encode import EncodeOptions, encode
from mavlink.formats import FormatError, read_waypoints, write_waypoints
from mavlink.items import Command, Frame
from mavlink.mission import Mission
from tests.mavlink.plans import make_plan
from tests.mavlink.strategies import missions, same

GOOD = write_waypoints(encode(make_plan()))


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_pymavlink_reads_the_file_item_by_item(autopilot: Autopilot, tmp_path: Path) -> None:
    """MAVWPLoader finds the same items, with home in front of PX4's."""
    mission = encode(make_plan(), autopilot=autopilot, options=EncodeOptions(home_altitude_m=120.0))
    file = tmp_path / "mission.waypoints"
    file.write_text(write_waypoints(mission))
    loader = mavwp.MAVWPLoader()
    ahead = 0 if autopilot == "ardupilot" else 1
    assert loader.load(str(file)) == len(mission.mission) + ahead
    home = loader.wp(0)
    assert (home.frame, home.command, home.z) == (Frame.GLOBAL, Command.NAV_WAYPOINT, 120.0)
    assert (home.y, home.x) == pytest.approx(mission.home, abs=5e-8)
    for item in mission.mission[1 - ahead :]:
        read = loader.wp(item.seq + ahead)
        assert (read.frame, read.command, read.autocontinue) == (item.frame, item.command, 1)
        values = (read.param1, read.param2, read.param3, read.param4, read.z)
        assert values == pytest.approx(
            (item.param1, item.param2, item.param3, item.param4, item.z), nan_ok=True
        )
        scale = 1.0 if item.frame == Frame.MISSION else 1e7
        assert (round(read.x * scale), round(read.y * scale)) == (item.x, item.y)


@given(missions())
@settings(max_examples=150, deadline=None)
def test_what_is_written_is_read(mission: Mission) -> None:
    """Any mission comes back from its file, NaN, jumps and raw integers included."""
    read = read_waypoints(write_waypoints(mission), mission.autopilot, mission.vehicle_type)
    assert same(read.mission, mission.mission)
    assert read.home == mission.home
    assert read.home_altitude_m == mission.home_altitude_m


@given(
    st.lists(st.sampled_from(["\n", "\r\n"]), min_size=60, max_size=60),
    st.sampled_from(["", "\n", "\r\n \r\n"]),
)
def test_line_ends_may_be_mixed(ends: list[str], tail: str) -> None:
    """LF, CR LF and both in one file, with and without blank lines at the end, mean the same."""
    lines = GOOD.splitlines()
    text = "".join(line + end for line, end in zip(lines, ends, strict=False)) + tail
    assert read_waypoints(text) == read_waypoints(GOOD)


def test_no_line_end_at_the_end_is_fine() -> None:
    """The last line may just stop, and a byte order mark may stand in front."""
    assert read_waypoints("\ufeff" + GOOD.rstrip("\n")) == read_waypoints(GOOD)


def test_columns_divided_by_spaces_are_read() -> None:
    """Some programs write spaces for tabs."""
    assert read_waypoints(GOOD.replace("\t", "   ")) == read_waypoints(GOOD)


def changed(line: int, column: int, value: str) -> str:
    lines = GOOD.splitlines()
    fields = lines[line - 1].split("\t")
    fields[column] = value
    lines[line - 1] = "\t".join(fields)
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("", 1, "QGC WPL 110"),
        ("QGC WPL 120\n", 1, "QGC WPL 110"),
        ("QGC WPL 110\n", 2, "home row"),
        (GOOD.replace("\n4\t", "\n\n4\t"), 6, "12 columns"),
        ("\n".join([*GOOD.splitlines()[:5], "4\t0\t3"]), 6, "12 columns are meant, here are 3"),
        (changed(4, 0, "7"), 4, "item 7 stands where item 2 belongs"),
        (changed(4, 3, "way"), 4, "command 'way' is no number"),
        (changed(4, 3, "16.5"), 4, "no whole number"),
        (changed(4, 3, "70000"), 4, "command 70000"),
        (changed(4, 5, ""), 4, "param 2"),
        (changed(4, 8, "999"), 4, "latitude '999' is out of range"),
        (changed(4, 9, "nan"), 4, "longitude"),
        (changed(2, 3, "22"), 2, "home position"),
    ],
)
def test_errors_name_the_line(text: str, line: int, says: str) -> None:
    """Each fault is told with its line and what is wrong there."""
    with pytest.raises(FormatError, match=says) as caught:
        read_waypoints(text)
    assert caught.value.line == line
    assert str(caught.value).startswith(f"line {line}: ")


@given(st.text(max_size=200))
def test_any_text_is_read_or_refused(text: str) -> None:
    """Rubbish raises FormatError and nothing else."""
    with pytest.raises(FormatError):
        read_waypoints("QGC WPL 110\n" + text)


def test_open_yaws_stay_open() -> None:
    """PX4's NaN is written as nan."""
    mission = encode(make_plan(), autopilot="px4")
    read = read_waypoints(write_waypoints(mission), "px4")
    assert math.isnan(read.mission[0].param4)
    assert read.mission[0].current
