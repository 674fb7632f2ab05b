"""The order of the suite."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from tests import order

ROOT = Path(__file__).resolve().parents[1]
UNITS = st.lists(
    st.sampled_from(
        ("tests/app", "tests/flows", "tests/mavlink/sim", "tests/planner", "tests/mavlink/wire")
    ).flatmap(lambda folder: st.integers(0, 30).map(lambda number: f"{folder}/test_{number}.py")),
    unique=True,
)


@given(UNITS)
def test_those_that_wait_run_among_those_that_compute(units: list[str]) -> None:
    """Nothing is lost or doubled, and at any time about the same share of either kind has begun."""
    placed = order.in_order(units)
    assert sorted(placed) == sorted(units)
    waiting = [order.waits(unit) for unit in placed]
    for begun in range(len(placed) + 1):
        ahead = sum(waiting[:begun]) - begun * sum(waiting) / max(1, len(placed))
        assert abs(ahead) <= 1.0


def test_what_takes_long_begins_first() -> None:
    """Each name in the list of long ones is a unit that there is, and precedes all others of its kind."""
    files = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "tests").rglob("test_*.py"))
    units = {order.unit_of(path + "::test") for path in files}
    assert units >= set(order.LONG)
    placed = order.in_order(sorted(units))
    for kind in (True, False):
        long = [unit for unit in order.LONG if order.waits(unit) is kind]
        assert [unit for unit in placed if order.waits(unit) is kind][: len(long)] == long


def test_files_that_share_what_is_costly_stay_together() -> None:
    """Every file of the browser's tests is of one unit; another file is one by itself."""
    assert order.unit_of("tests/app/browser/test_world_page.py::test_a[x::y]") == "tests/app/browser"
    assert order.unit_of("tests/app/test_arcs.py::test_a[tests/app/browser/]") == "tests/app/test_arcs.py"
