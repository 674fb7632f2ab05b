"""Plans over HTTP, with a stand-in for the planner."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import pytest_asyncio

from app.main import create_app
from app.services.store.database import Database, DatabaseInUseError
from app.settings import Settings
from tests.app.conftest import pooled_house, serving, settings_in
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.asyncio(loop_scope="module")

PLANS = "/api/v1/plans"


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def service(
    tmp_path_factory: pytest.TempPathFactory,
) -> AsyncIterator[tuple[httpx.AsyncClient, Settings]]:
    """A service that plans in processes, which can be killed; begun once, as that takes seconds."""
    settings = settings_in(tmp_path_factory.mktemp("plans"))
    async with serving(create_app(settings, pooled_house)) as client:
        yield client, settings


@pytest.fixture
def client(service: tuple[httpx.AsyncClient, Settings]) -> httpx.AsyncClient:
    """A client of that service."""
    return service[0]


def scenario(fake: str = "done", **members: Any) -> dict[str, Any]:
    """A scenario the stand-in understands."""
    return {"type": "FeatureCollection", "name": "x", "features": [{}], "fake": fake, **members}


async def state_of(client: httpx.AsyncClient, place: str, *states: str) -> dict[str, Any]:
    """The record once it is in one of some states."""
    async with asyncio.timeout(PATIENCE_S):
        while (record := (await client.get(place)).json())["state"] not in states:
            await asyncio.sleep(0.02)
    return record


async def test_post_answers_202_with_location_and_plans(client: httpx.AsyncClient) -> None:
    """A posted scenario is planned and its plan can be read at the place told."""
    answer = await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})
    assert answer.status_code == 202
    record = answer.json()
    assert answer.headers["location"] == f"{PLANS}/{record['id']}"
    assert (record["state"], record["progress"], record["metrics"]) == ("done", 1.0, {"length_m": 1.0})
    assert (await client.get(PLANS)).json()["plans"][0] == record
    assert (await client.get(answer.headers["location"])).json() == record


async def test_events_end_with_the_end_state(client: httpx.AsyncClient) -> None:
    """Events tell progress, then the end; of an ended plan they tell the end at once."""
    place = (await client.post(PLANS, json=scenario())).headers["location"]
    for _ in range(2):
        answer = await client.get(place + "/events")
        assert answer.headers["content-type"].startswith("text/event-stream")
        names = [line[7:] for line in answer.text.splitlines() if line.startswith("event: ")]
        assert names[-1] == "done"
        assert set(names[:-1]) <= {"progress"}


def events_in(text: str) -> list[tuple[str, dict[str, Any]]]:
    """The names and data of a stream's events."""
    lines = text.splitlines()
    names = [line[7:] for line in lines if line.startswith("event: ")]
    data = [json.loads(line[6:]) for line in lines if line.startswith("data: ")]
    return list(zip(names, data, strict=True))


async def test_bound_follows_the_plan(client: httpx.AsyncClient) -> None:
    """A plan is done, and can be read, before its bound, which comes as an event and is in the plan then."""
    answer = await client.post(PLANS, json=scenario(fake_bound="slow"), params={"wait": PATIENCE_S})
    place = answer.headers["location"]
    assert (answer.json()["state"], answer.json()["metrics"]) == ("done", {"length_m": 1.0})
    assert (await client.get(place + "/plan.geojson")).json()["metrics"] == {"length_m": 1.0}
    watched = asyncio.create_task(client.get(place + "/events"))
    # Until the watcher is served: it must not come after the bound.
    await asyncio.sleep(1.0)
    # Another plan needs the one worker: the bound ends with what it has.
    other = (await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})).json()
    assert other["state"] == "done"
    (first, before), (second, after) = events_in((await watched).text)
    assert (first, second) == ("done", "bound")
    assert before["metrics"] == {"length_m": 1.0}
    assert after["metrics"] == {"length_m": 1.0, "lower_bound_m": 0.9, "gap": 0.1}
    assert (await client.get(place + "/plan.geojson")).json()["metrics"] == after["metrics"]
    assert [name for name, _ in events_in((await client.get(place + "/events")).text)] == ["done"]


@pytest.mark.parametrize("fake", ["raise", None])
async def test_plan_without_a_bound_stays_good(client: httpx.AsyncClient, fake: str | None) -> None:
    """Where there is no bound the events end with the plan, and the next plan gets its own."""
    place = (await client.post(PLANS, json=scenario(fake_bound=fake))).headers["location"]
    assert [name for name, _ in events_in((await client.get(place + "/events")).text)][-1] == "done"
    assert (await client.get(place)).json()["state"] == "done"
    place = (await client.post(PLANS, json=scenario(fake_bound="now"))).headers["location"]
    assert [name for name, _ in events_in((await client.get(place + "/events")).text)][-1] == "bound"


async def test_a_bound_that_makes_room_comes_later(client: httpx.AsyncClient, tmp_path: Path) -> None:
    """A search given up for another plan leaves no bound of its own, and is made anew when that is done."""
    begun = tmp_path / "begun"
    answer = await client.post(PLANS, json=scenario(fake_bound=str(begun)), params={"wait": PATIENCE_S})
    place = answer.headers["location"]
    watched = asyncio.create_task(client.get(place + "/events"))
    async with asyncio.timeout(PATIENCE_S):
        while not begun.exists():
            await asyncio.sleep(0.02)
    # Until the watcher is served: it must not come after the bound.
    await asyncio.sleep(1.0)
    other = (await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})).json()
    assert other["state"] == "done"
    async with asyncio.timeout(PATIENCE_S):
        (first, before), (second, after) = events_in((await watched).text)
    assert (first, second) == ("done", "bound")
    assert before["metrics"] == {"length_m": 1.0}
    assert after["metrics"] == {"length_m": 1.0, "lower_bound_m": 0.9, "gap": 0.1}


async def test_deleted_plan_waits_for_no_bound(client: httpx.AsyncClient) -> None:
    """Who watches a plan deleted before its bound is let go."""
    place = (await client.post(PLANS, json=scenario(fake_bound="slow"), params={"wait": PATIENCE_S})).headers[
        "location"
    ]
    watched = asyncio.create_task(client.get(place + "/events"))
    await asyncio.sleep(0.2)
    assert (await client.delete(place)).status_code == 204
    async with asyncio.timeout(PATIENCE_S):
        assert [name for name, _ in events_in((await watched).text)] == ["done"]
    assert (await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})).json()["state"] == "done"


async def test_running_plan_reports_progress_and_can_be_cancelled(
    client: httpx.AsyncClient,
) -> None:
    """A running plan tells its stage; deleting cancels it, deleting again removes it."""
    place = (await client.post(PLANS, json=scenario("slow"))).headers["location"]
    await state_of(client, place, "running")
    async with asyncio.timeout(PATIENCE_S):
        while (await client.get(place)).json()["progress"] < 0.25:
            await asyncio.sleep(0.02)
    assert (await client.get(place)).json()["stage"]
    cancelled = await client.delete(place)
    assert (cancelled.status_code, cancelled.json()["state"]) == (200, "cancelled")
    assert (await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})).json()["state"] == "done"
    assert (await client.get(place)).json()["state"] == "cancelled"
    assert (await client.delete(place)).status_code == 204
    assert (await client.get(place)).status_code == 404


async def test_queued_plan_can_be_cancelled(client: httpx.AsyncClient) -> None:
    """A plan cancelled while it waits is never started."""
    slow = (await client.post(PLANS, json=scenario("slow"))).headers["location"]
    await state_of(client, slow, "running")
    waiting = (await client.post(PLANS, json=scenario())).headers["location"]
    assert (await client.get(waiting)).json()["state"] == "queued"
    assert (await client.delete(waiting)).json()["state"] == "cancelled"
    await client.delete(slow)
    assert (await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})).json()["state"] == "done"
    assert (await client.get(waiting)).json()["started_at"] is None


@pytest.mark.parametrize(
    ("fake", "kind", "word"),
    [("die", "worker-died", "signal 9"), ("raise", "internal", "log"), ("failed", "infeasible", "no way")],
)
async def test_failed_plan_tells_why_and_the_next_one_runs(
    client: httpx.AsyncClient, fake: str, kind: str, word: str
) -> None:
    """However planning fails, the plan says so, without the inside's words, and the next plan runs."""
    record = (await client.post(PLANS, json=scenario(fake), params={"wait": PATIENCE_S})).json()
    assert (record["state"], record["error"]["type"]) == ("failed", kind)
    assert word in record["error"]["detail"]
    assert "secret" not in json.dumps(record)
    missing = await client.get(f"{PLANS}/{record['id']}/plan.geojson")
    assert missing.status_code == 409
    assert (await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})).json()["state"] == "done"


async def test_time_limit_fails_the_plan(settings: Settings) -> None:
    """A plan that takes too long is stopped and says so."""
    limited = settings.model_copy(update={"plan_time_limit_s": 0.5})
    async with serving(create_app(limited, pooled_house)) as client:
        record = (await client.post(PLANS, json=scenario("slow"), params={"wait": PATIENCE_S})).json()
        assert record["error"]["type"] == "time-limit"
        assert (await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})).json()[
            "state"
        ] == "done"


async def test_plans_survive_a_restart(settings: Settings) -> None:
    """After a restart done plans are there, and those cut off or waiting are made."""
    async with serving(create_app(settings, pooled_house)) as client:
        done = (await client.post(PLANS, json=scenario(), params={"wait": PATIENCE_S})).json()
        cut = (await client.post(PLANS, json=scenario("slow"))).headers["location"]
        await state_of(client, cut, "running")
        waiting = (await client.post(PLANS, json=scenario())).headers["location"]
    async with serving(create_app(settings, pooled_house)) as client:
        assert (await client.get(f"{PLANS}/{done['id']}")).json() == done
        await state_of(client, cut, "running")
        await client.delete(cut)
        await state_of(client, waiting, "done")


async def test_second_service_on_a_database_is_refused(service: tuple[httpx.AsyncClient, Settings]) -> None:
    """Two services never share a database file: each would take the other's running plans for dead."""
    client, settings = service
    assert (await client.get("/health/ready")).json()["checks"]["database"]
    with pytest.raises(DatabaseInUseError):
        await Database(settings.database).open()


async def test_idempotency_key(client: httpx.AsyncClient) -> None:
    """A key stands for one scenario; posting it again makes no second plan."""
    headers = {"Idempotency-Key": "k"}
    before = (await client.get(PLANS)).json()["total"]
    first = await client.post(PLANS, json=scenario(), headers=headers)
    again = await client.post(PLANS, json=scenario(), headers=headers)
    other = await client.post(PLANS, json=scenario(seed=1), headers=headers)
    assert first.json()["id"] == again.json()["id"]
    assert other.status_code == 409
    assert (await client.get(PLANS)).json()["total"] == before + 1


async def test_full_queue_is_a_429(settings: Settings) -> None:
    """When too many plans wait, the next is refused and told when to come back."""
    async with serving(
        create_app(settings.model_copy(update={"max_queued_plans": 1}), pooled_house)
    ) as client:
        slow = (await client.post(PLANS, json=scenario("slow"))).headers["location"]
        await state_of(client, slow, "running")
        assert (await client.post(PLANS, json=scenario())).status_code == 202
        refused = await client.post(PLANS, json=scenario())
        assert refused.status_code == 429
        assert int(refused.headers["retry-after"]) > 0
