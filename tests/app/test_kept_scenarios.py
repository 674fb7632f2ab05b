"""Kept scenarios: two tabs do not overwrite each other's work, and plans of another text are named stale."""

from __future__ import annotations

import asyncio
import contextlib
import sqlite3
from pathlib import Path
from typing import Any

import httpx

from app.services.store.tables import Base
from app.settings import Settings
from tests.app.conftest import stored
from tests.app.test_problems import check_problem
from tests.app.test_restart import service
from tests.app.test_vehicles import connected
from tests.patience import PATIENCE_S

SCENARIOS = "/api/v1/scenarios"
#: Neither finished nor valid: what somebody has drawn so far.
DRAFT: dict[str, Any] = {"type": "FeatureCollection", "name": "harbour", "features": [{"type": "Feature"}]}


async def kept(client: httpx.AsyncClient, document: dict[str, Any]) -> httpx.Response:
    """The answer to keeping a new scenario."""
    answer = await client.post(SCENARIOS, json=document)
    assert answer.status_code == 201, answer.text
    return answer


async def save(client: httpx.AsyncClient, place: str, document: Any, revision: str) -> httpx.Response:
    """A tab saves what it holds, from the revision it has read."""
    return await client.put(place, json=document, headers={"If-Match": revision})


async def test_a_draft_is_kept_as_it_is_and_listed_without_its_text(client: httpx.AsyncClient) -> None:
    """An unfinished scenario comes back unchanged, its revision as ETag; the last changed is listed first."""
    answer = await kept(client, DRAFT)
    assert (answer.json()["name"], answer.json()["revision"], answer.headers["etag"]) == ("harbour", 1, '"1"')
    await kept(client, {"features": []})
    place = answer.headers["location"]
    assert (await save(client, place, DRAFT | {"seed": 1}, '"1"')).json()["revision"] == 2
    read = await client.get(place)
    assert read.headers["etag"] == '"2"'
    assert read.json()["scenario"] == DRAFT | {"seed": 1}
    listed = (await client.get(SCENARIOS)).json()
    assert [each["name"] for each in listed["scenarios"]] == ["harbour", "scenario"]
    assert listed["total"] == 2
    assert not any("scenario" in each for each in listed["scenarios"])


async def test_two_tabs_do_not_overwrite_each_other(client: httpx.AsyncClient) -> None:
    """Of two tabs that save from one revision the second is told, and what the first saved stands."""
    place = (await kept(client, DRAFT)).headers["location"]
    texts = [DRAFT | {"seed": seed} for seed in range(8)]
    answers = await asyncio.gather(*(save(client, place, text, '"1"') for text in texts))
    (won,) = [index for index, answer in enumerate(answers) if answer.status_code == 200]
    for index, answer in enumerate(answers):
        if index != won:
            check_problem(answer, 412)
            assert answer.json()["type"].endswith(":scenario-changed")
            assert "revision 2" in answer.json()["detail"]
    assert (await client.get(place)).json()["scenario"] == texts[won]
    # The same text again is no change, so the tab that saved it is not put off.
    assert (await save(client, place, texts[won], '"1"')).json()["revision"] == 2
    assert (await save(client, place, DRAFT, 'W/"2"')).json()["revision"] == 3
    assert (await save(client, place, DRAFT | {"seed": 9}, "*")).json()["revision"] == 4
    check_problem(await client.delete(place, headers={"If-Match": '"3"'}), 412)
    assert (await client.delete(place, headers={"If-Match": '"4"'})).status_code == 204
    check_problem(await client.get(place), 404)
    check_problem(await save(client, place, DRAFT, "*"), 404)


async def test_a_change_without_its_revision_is_refused(client: httpx.AsyncClient) -> None:
    """Whoever does not say what the change was made to cannot change anything."""
    place = (await kept(client, DRAFT)).headers["location"]
    check_problem(await client.put(place, json={"features": []}), 422)
    check_problem(await save(client, place, {"features": []}, "new"), 422, "if-match")
    check_problem(await save(client, place, ["no object"], '"1"'), 422, "not-an-object")
    assert (await client.get(place)).json()["scenario"] == DRAFT


async def test_a_plan_is_stale_while_its_scenario_is_another(
    client: httpx.AsyncClient, plan_file: Path
) -> None:
    """Changed: stale; changed back: not; deleted: stale for good. Plans of no kept scenario are neither."""
    text = {"features": [{}], "name": "x", "fake_plan": str(plan_file), "members": {}}
    answer = await kept(client, text)
    place, scenario_id = answer.headers["location"], answer.json()["id"]
    posted = await client.post(
        "/api/v1/plans", json=text, params={"wait": PATIENCE_S, "scenario_id": scenario_id}
    )
    plan = posted.headers["location"]
    record = posted.json()
    assert (record["state"], record["scenario_id"], record["stale"]) == ("done", scenario_id, False)
    assert record["stale_reason"] is None

    async def stale() -> tuple[bool | None, str | None]:
        record = (await client.get(plan)).json()
        (listed,) = (await client.get("/api/v1/plans")).json()["plans"]
        assert (listed["stale"], listed["stale_reason"]) == (record["stale"], record["stale_reason"])
        return record["stale"], record["stale_reason"]

    await save(client, place, text | {"seed": 2}, '"1"')
    changed, reason = await stale()
    assert changed
    assert "changed since" in (reason or "")
    await save(client, place, text, '"2"')
    assert await stale() == (False, None)
    await client.delete(place)
    deleted, reason = await stale()
    assert deleted
    assert "deleted" in (reason or "")
    other = (await client.get(f"/api/v1/plans/{await stored(client, plan_file)}")).json()
    assert (other["scenario_id"], other["stale"]) == (None, None)
    missing = {"scenario_id": "never-kept"}
    check_problem(await client.post("/api/v1/plans", json=text, params=missing), 404)


async def test_a_stale_plan_goes_up_only_with_a_recorded_override(
    client: httpx.AsyncClient, plan_file: Path, settings: Settings
) -> None:
    """Refused by the service itself; with a reason it goes up, and the log of uploads keeps that."""
    text = {"features": [{}], "name": "x", "fake_plan": str(plan_file), "members": {}}
    answer = await kept(client, text)
    params = {"wait": PATIENCE_S, "scenario_id": answer.json()["id"]}
    plan_id = (await client.post("/api/v1/plans", json=text, params=params)).json()["id"]
    await save(client, answer.headers["location"], text | {"name": "a zone was moved"}, '"1"')
    vehicle = await connected(client)
    refused = await client.post(vehicle + "/mission", json={"plan_id": plan_id})
    check_problem(refused, 409, "plan-stale")
    assert (await client.get(vehicle)).json()["plan_id"] is None
    body = {"plan_id": plan_id, "override": True, "reason": "the zone is not active"}
    report = (await client.post(vehicle + "/mission", json=body)).json()
    assert (report["outcome"], report["override_reason"]) == ("accepted", "the zone is not active")
    assert "plan-stale" in [finding["rule"] for finding in report["findings"]]
    with contextlib.closing(sqlite3.connect(settings.database)) as database:
        kept_reasons = database.execute("SELECT override_reason FROM uploads").fetchall()
    assert kept_reasons == [("the zone is not active",)]


async def test_kept_scenarios_outlive_the_service(settings: Settings) -> None:
    """What was saved is there after a restart, at its revision."""
    async with service(settings) as client:
        place = (await kept(client, DRAFT)).headers["location"]
        await save(client, place, DRAFT | {"seed": 3}, '"1"')
    async with service(settings) as client:
        assert (await client.get(place)).json()["revision"] == 2


async def test_migrations_make_the_tables_that_the_code_means(settings: Settings) -> None:
    """Every column of the tables in code is in the migrated file, and no other."""
    async with service(settings):
        pass
    with contextlib.closing(sqlite3.connect(settings.database)) as database:
        for table in Base.metadata.sorted_tables:
            found = {row[1] for row in database.execute(f"PRAGMA table_info({table.name})")}
            assert found == {column.name for column in table.columns}, table.name
