"""A service on a database of its own, with a stand-in for the planner."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.logging import configure
from app.main import create_app
from app.routers.bodies import EXAMPLE
from app.services.house import House
from app.services.limits import Limits
from app.services.links.keeper import Keeper
from app.services.plans.work import plan_scenario
from app.services.vehicles import audit
from app.services.vehicles.times import LinkTimes
from app.settings import Settings
from mavlink.transfer.machine import TransferSettings
from tests.app import fakes
from tests.patience import PATIENCE_S

#: Vehicles are looked at often, and links that failed opened anew at once.
QUICK = LinkTimes(telemetry_s=0.05, look_s=0.1, reopen_s=0.2)
#: The same for tests whose aircraft fall silent; fit for aircraft simulated in the test's own process alone.
IMPATIENT = replace(
    QUICK, lost_after_s=2.5, transfers=TransferSettings(timeout_s=0.5, silence_s=3.0, acknowledgement_s=0.5)
)


def fake_house(limits: Limits, times: LinkTimes = QUICK) -> House:
    """Services whose planner is a stand-in, and plans in the process of the test."""
    return House(
        limits,
        task=fakes.task,
        bound_task=fakes.bound,
        judge_scenario=fakes.judge,
        pool=fakes.ThreadPool(),
        times=times,
    )


def impatient_house(limits: Limits) -> House:
    """The same, with little patience for silent vehicles."""
    return fake_house(limits, IMPATIENT)


def pooled_house(limits: Limits, keeper: Keeper | None = None) -> House:
    """Services whose planner is a stand-in, in planning processes that can be killed."""
    return House(
        limits,
        task=fakes.task,
        bound_task=fakes.bound,
        judge_scenario=fakes.judge,
        initialiser=fakes.no_warm_up,
        keeper=keeper,
    )


@asynccontextmanager
async def serving(app: FastAPI) -> AsyncIterator[httpx.AsyncClient]:
    """A client of an application whose services run."""
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost") as client,
    ):
        yield client


@pytest.fixture(autouse=True, scope="session")
def _quiet_logs() -> None:
    """Log as the service does, errors alone."""
    configure("error")


@pytest.fixture(autouse=True)
def _patient_audit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Orders wait for a slow disk: where one is meant that does not answer, the test says how long."""
    monkeypatch.setattr(audit, "WAIT_S", 60.0)


def settings_in(folder: Path) -> Settings:
    """Settings of a small service in a folder, which may open what tests make there."""
    return Settings(
        database=folder / "plans.db",
        workers=1,
        request_workers=2,
        request_time_limit_s=PATIENCE_S,
        static_dir=folder,
        log_level="error",
        serial_ports=(str(folder / "*"), "/dev/none"),
    )


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """Settings of a small service of the test's own."""
    return settings_in(tmp_path)


@pytest.fixture
async def client(settings: Settings) -> AsyncIterator[httpx.AsyncClient]:
    """A client of a service with a stand-in for the planner."""
    async with serving(create_app(settings, fake_house)) as client:
        yield client


@pytest.fixture
async def impatient(settings: Settings) -> AsyncIterator[httpx.AsyncClient]:
    """A client of the same service, with little patience for silent vehicles."""
    async with serving(create_app(settings, impatient_house)) as client:
        yield client


@pytest.fixture(scope="session")
def plan_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with the plan of the example."""
    result = plan_scenario(json.dumps(EXAMPLE), "/dev/null")
    assert result.plan is not None
    path = tmp_path_factory.mktemp("plan") / "plan.geojson"
    path.write_text(result.plan)
    return path


@pytest.fixture
async def plan_id(client: httpx.AsyncClient, plan_file: Path) -> str:
    """The id of a plan of the example, made beforehand."""
    return await stored(client, plan_file)


async def stored(
    client: httpx.AsyncClient, plan_file: Path, scenario: dict[str, Any] | None = None, **members: Any
) -> str:
    """The id of a plan that is taken from a file, with some members exchanged."""
    scenario = (scenario or {"features": [{}], "name": "x"}) | {
        "fake_plan": str(plan_file),
        "members": members,
    }
    record = (await client.post("/api/v1/plans", json=scenario, params={"wait": PATIENCE_S})).json()
    assert record["state"] == "done", record
    return str(record["id"])
