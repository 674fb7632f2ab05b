"""What is told of a mission replaced in flight."""

from __future__ import annotations

import pytest

from app.services.vehicles.replaced import Replaced
from mavlink.state.passes import LeadIn


@pytest.mark.parametrize("mode", ["RTL", "AUTO.LOITER"])
def test_one_that_has_left_its_mission_is_told_how_it_is_flown(mode: str) -> None:
    """Given fewer items than it has flown an aircraft returns or waits, whatever item it names."""
    told = str(Replaced(mode, 1, 23, (), None))
    assert f"has left its mission (mode {mode})" in told
    assert "goto_item 1, then resume" in told


def test_one_on_its_mission_goes_on_at_an_item() -> None:
    """With what lies behind it there."""
    told = str(Replaced("AUTO", 7, 23, ((1, "pond"),), None))
    assert "goes on at item 7 of 22 (mode AUTO); skipped: pass 1 (pond)" in told
    assert "goto_item" not in told
    again = str(Replaced("AUTO", 7, 23, ((1, "pond"),), None, LeadIn(3, whole=True)))
    assert again.endswith("goto_item 3 flies it whole")
