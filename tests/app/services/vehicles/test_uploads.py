"""What an upload's parts tell of the vehicle's answer."""

from __future__ import annotations

from app.services.vehicles.uploads import PartResult
from mavlink.station.verify import VerifiedUpload
from mavlink.transfer.outcome import Accepted
from tests.mavlink.transfer.vehicle import waypoints


def test_a_mission_that_is_held_and_will_not_be_flown_is_refused() -> None:
    """PX4 acknowledges it and objects in events: the reasons are told, and it does not count as verified."""
    items = tuple(waypoints(3))
    part = PartResult(meant=3)
    part.take(VerifiedUpload(Accepted(), items, (), None, ("a landing is required", "too steep")))
    assert (part.outcome, part.reason) == ("refused", "a landing is required; too steep")
    assert not part.verified
    assert part.held is not None
    assert len(part.held) == 3
    part.take(VerifiedUpload(Accepted(), items))
    assert part.verified
