"""Which commands the firmware at hand takes, by its version."""

from __future__ import annotations

import pytest

from mavlink.dialects import Autopilot
from mavlink.dialects.versions import SINCE, Version, version_findings
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.gimbal import Gimbal
from mavlink.rules.firmware import KNOWN
from mavlink.wire.items import Command
from planner.plan import Trigger
from tests.mavlink.cameras import with_photos
from tests.mavlink.plans import make_plan


@pytest.mark.parametrize(
    ("trigger", "autopilot", "version", "refused"),
    [
        ("time", "ardupilot", (4, 3), {Command.IMAGE_START_CAPTURE, Command.IMAGE_STOP_CAPTURE}),
        ("time", "ardupilot", (4, 4), {Command.IMAGE_STOP_CAPTURE}),
        ("time", "ardupilot", (4, 5), set()),
        ("video", "ardupilot", (4, 3), {Command.VIDEO_START_CAPTURE, Command.VIDEO_STOP_CAPTURE}),
        ("distance", "ardupilot", (4, 0), set()),
        ("distance", "px4", (1, 11), set()),
        ("time", "ardupilot", None, set()),
    ],
)
def test_what_a_firmware_does_not_know_is_named(
    trigger: Trigger, autopilot: Autopilot, version: Version | None, refused: set[int]
) -> None:
    """Each command once, with the version that it needs and what to write instead."""
    plan = with_photos(make_plan(autopilot=autopilot), trigger=trigger)
    found = list(version_findings(encode(plan).mission, autopilot, version))
    assert {encode(plan).mission[each.seq or 0].command for each in found} == refused
    assert len(found) == len(refused)
    assert all("from version 4." in each.message and each.fix for each in found)


def test_all_known_versions_take_what_is_encoded() -> None:
    """Photos, videos, gimbals and outputs are taken by every version that is known here."""
    for autopilot, (first, _) in KNOWN.items():
        if autopilot not in SINCE:
            continue
        for trigger in ("distance", "time", "video"):
            plan = with_photos(make_plan(autopilot=autopilot), trigger=trigger, collects=1)
            mission = encode(plan, options=EncodeOptions(gimbal=Gimbal("manager", 0.0)))
            assert not list(version_findings(mission.mission, autopilot, first))
