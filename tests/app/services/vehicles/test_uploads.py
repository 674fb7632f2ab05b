"""What an upload's parts tell of the vehicle's answer."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.services.errors import RefusedError
from app.services.vehicles.uploads import PartResult, judge_upload
from mavlink.encoding.encode import encode
from mavlink.state.telemetry import VehicleState
from mavlink.station.verify import VerifiedUpload
from mavlink.transfer.outcome import Accepted
from tests.mavlink.cameras import with_photos
from tests.mavlink.plans import make_plan
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


def test_a_command_that_the_firmware_does_not_know_is_refused_unsent() -> None:
    """By the version that the vehicle tells; unknown versions are asked by the upload itself."""
    plan = with_photos(make_plan(), trigger="time")
    mission = encode(plan)
    state = VehicleState(connected=True, autopilot="ardupilot", type="fixed_wing", firmware="4.3.8")
    with pytest.raises(RefusedError, match="is taken from version") as refused:
        judge_upload(plan, mission, ["mission"], state, None)
    assert {finding.rule for finding in refused.value.findings} == {"firmware-too-old"}
    for firmware in (None, "4.6.2"):
        assert judge_upload(plan, mission, ["mission"], replace(state, firmware=firmware), None) == ()
