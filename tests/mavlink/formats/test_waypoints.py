"""QGC WPL 110, read by pymavlink and by ourselves."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink import mavwp

from mavlink.dialects import Autopilot
from mavlink.dialects.mission import Mission
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.formats import FormatError, read_waypoints, write_waypoints
from mavlink.wire.items import Command, Frame, MissionItem
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


def without_nan(items: tuple[MissionItem, ...], autopilot: Autopilot) -> tuple[MissionItem, ...]:
    """ArduPilot has no open parameters: its files say 0."""
    if autopilot == "px4":
        return items
    names = ("param1", "param2", "param3", "param4", "z")
    return tuple(
        replace(item, **{name: 0.0 for name in names if math.isnan(getattr(item, name))}) for item in items
    )


@given(missions())
@settings(max_examples=150, deadline=None)
def test_what_is_written_is_read(mission: Mission) -> None:
    """Any mission comes back from its file, jumps, raw integers and PX4's NaN included."""
    read = read_waypoints(write_waypoints(mission), mission.autopilot, mission.vehicle_type)
    assert same(read.mission, without_nan(mission.mission, mission.autopilot))
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


def swapped() -> str:
    lines = GOOD.splitlines()
    rows = [line.split("\t") for line in lines[1:]]
    for fields in rows:
        fields[8], fields[9] = fields[9], fields[8]
    return "\n".join([lines[0], *("\t".join(fields) for fields in rows)])


@pytest.mark.parametrize(
    ("text", "line", "column", "says"),
    [
        ("", 1, None, "QGC WPL 110"),
        ("QGC WPL 130\n", 1, "version", "the version is '130'"),
        ("QGC WPL\n", 1, "version", "the version is ''"),
        ("{}", 1, None, "it begins with '{}'"),
        ("\n".join([*GOOD.splitlines()[:5], "4\t0\t3"]), 6, "command", "here are 3: command is missing"),
        (changed(4, 11, "1\tjunk\tmore"), 4, None, "here are 14: 'junk more' is too much"),
        (GOOD + "end of file\n", len(GOOD.splitlines()) + 1, "command", "here are 3"),
        (changed(4, 3, "way"), 4, "command", "command 'way' is no number"),
        (changed(4, 3, "16.5"), 4, "command", "no whole number"),
        (changed(4, 3, "70000"), 4, "command", "command 70000"),
        (changed(4, 10, "500,5"), 4, "altitude", "write a point for the comma"),
        (changed(3, 8, "999"), 3, "latitude", "latitude 999 is out of range"),
        (changed(3, 9, "181"), 3, "longitude", "longitude 181 is out of range$"),
        (changed(4, 8, "inf"), 4, "latitude", "latitude 'inf'"),
        (swapped(), 2, "latitude", "latitude -117.753 is out of range: .* seem to be swapped"),
    ],
)
def test_errors_name_the_line_and_the_column(text: str, line: int, column: str | None, says: str) -> None:
    """Each fault is told with its line, its column and what is wrong there."""
    with pytest.raises(FormatError, match=says) as caught:
        read_waypoints(text)
    assert (caught.value.line, caught.value.column) == (line, column)
    assert str(caught.value).startswith(f"line {line}: ")


def test_a_file_of_mission_planner_is_read() -> None:
    """Its home row has frame 0, its lines end in CR LF, its numbers have a fixed count of digits."""
    rows = [
        "QGC WPL 110",
        "0\t1\t0\t16\t0\t0\t0\t0\t-35.3632622\t149.1652374\t583.990000\t1",
        "1\t0\t3\t22\t15.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t50.000000\t1",
        "2\t0\t3\t16\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t-35.36300000\t149.16600000\t100.000000\t1",
        "3\t0\t3\t183\t9.00000000\t1900.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.000000\t1",
        "4\t0\t0\t177\t2.00000000\t3.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.000000\t1",
    ]
    mission = read_waypoints("\r\n".join(rows) + "\r\n")
    assert mission.home == (149.1652374, -35.3632622)
    assert mission.home_altitude_m == 583.99
    assert [int(item.command) for item in mission.mission] == [16, 22, 16, 183, 177]
    assert mission.mission[4].param1 == 2.0
    assert read_waypoints("\r\n".join(rows), "px4").mission[3].param1 == 1.0


@given(st.text(max_size=200))
def test_any_text_is_read_or_refused(text: str) -> None:
    """Rubbish raises FormatError and nothing else; comments and blank lines alone are an empty mission."""
    try:
        mission = read_waypoints("QGC WPL 110\n" + text)
    except FormatError:
        return
    assert len(mission.mission) == 1
    assert not any(line.partition("#")[0].strip() for line in re.split(r"\r\n|\n|\r", text))


@given(st.integers(0, 40), st.integers(0, 13), st.text(max_size=12) | st.floats().map(str))
def test_any_field_may_be_anything(line: int, column: int, value: str) -> None:
    """A field of a good file replaced by rubbish gives a mission or FormatError."""
    lines = GOOD.splitlines()
    line %= len(lines)
    fields = lines[line].split("\t")
    fields[column % len(fields)] = value
    lines[line] = "\t".join(fields)
    try:
        mission = read_waypoints("\n".join(lines))
    except FormatError as error:
        found = error
    else:
        assert len(mission.mission) >= 1
        return
    assert found.line is not None


def test_open_yaws_stay_open() -> None:
    """PX4's NaN is written as nan."""
    mission = encode(make_plan(), autopilot="px4")
    read = read_waypoints(write_waypoints(mission), "px4")
    assert math.isnan(read.mission[0].param4)
    assert read.mission[0].current
