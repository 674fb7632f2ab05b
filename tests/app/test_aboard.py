"""What is on board is asked before it is flown: a restart that empties the mission does not go unnoticed."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from app.main import create_app
from app.settings import Settings
from mavlink.links.link import open_link
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from tests.app.conftest import impatient_house, serving, stored
from tests.app.test_problems import check_problem
from tests.app.test_restart import VEHICLES, flying, free_port, until
from tests.patience import PATIENCE_S


@asynccontextmanager
async def aircraft(port: int, settings: SimSettings) -> AsyncIterator[None]:
    """A simulated aircraft that has just started, at a port that listens."""
    link = await open_link(f"tcp:127.0.0.1:{port}")
    try:
        async with flying(link, settings):
            yield
    finally:
        await link.close()


@pytest.mark.parametrize("flavour", list(Flavour))
async def test_a_restart_empties_the_mission_and_nothing_is_started(
    settings: Settings, plan_file: Path, flavour: Flavour
) -> None:
    """Back within a second: it is told as not held, start and arm are refused; uploaded anew they go."""
    port = free_port()
    sim = SimSettings(autopilot=flavour)
    async with serving(create_app(settings, impatient_house)) as client:
        answer = await client.post(
            VEHICLES, json={"name": "uav", "url": f"tcpin:127.0.0.1:{port}", "timeout_s": 0.1}
        )
        place = answer.headers["location"]
        plan_id = await stored(client, plan_file)
        async with aircraft(port, sim):
            await until(client, lambda body: (body["state"]["time_s"] or 0.0) > 2.5)
            report = await client.post(place + "/mission", json={"plan_id": plan_id})
            assert report.json()["verified"], report.text
            assert (await client.get(place)).json()["sent"]["standing"] == "held"
        async with aircraft(port, sim):
            # The aircraft before left no word; whatever is known of its successor by now, it is asked.
            for wish in ({"command": "start", "arm_first": True}, {"command": "arm", "hold_first": True}):
                refused = await client.post(place + "/commands", json=wish)
                check_problem(refused, 409)
                assert refused.json()["errors"][0]["rule"] == "mission-differs", refused.text
            body = await until(client, lambda body: body["state"]["restarts"] == 1)
            body = await until(client, lambda body: body["sent"]["standing"] == "differs")
            assert body["plan_id"] is None
            assert not body["state"]["armed"]
            async with asyncio.timeout(PATIENCE_S):
                # It may just be read back once more.
                while (report := await client.post(place + "/mission", json={"plan_id": plan_id})).is_error:
                    assert report.json()["type"].endswith(":busy"), report.text
                    await asyncio.sleep(0.05)
            assert report.json()["verified"], report.text
            started = await client.post(place + "/commands", json={"command": "start", "arm_first": True})
            assert started.json().get("outcome") == "done", started.text


async def test_what_nobody_sent_is_not_asked_for(settings: Settings) -> None:
    """An aircraft that holds what it likes is armed; one whose mission was cleared from here, too."""
    async with serving(create_app(settings, impatient_house)) as client:
        answer = await client.post(VEHICLES, json={"name": "uav", "url": "sim:?autopilot=ardupilot"})
        place = answer.headers["location"]
        for command in ("arm", "disarm"):
            done = await client.post(place + "/commands", json={"command": command})
            assert done.json()["outcome"] == "done", done.text
