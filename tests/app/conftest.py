"""A service on a database of its own, with a stand-in for the planner."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from app.logging import configure
from app.main import create_app
from app.services.house import House, Limits
from app.settings import Settings
from tests.app import fakes


def fake_house(limits: Limits) -> House:
    """Services whose planner is a stand-in."""
    return House(limits, task=fakes.task, judge_scenario=fakes.judge, initialiser=fakes.no_warm_up)


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


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """Settings of a small service."""
    return Settings(database=tmp_path / "plans.db", workers=1, static_dir=tmp_path, log_level="error")


@pytest.fixture
async def client(settings: Settings) -> AsyncIterator[httpx.AsyncClient]:
    """A client of a service with a stand-in for the planner."""
    async with serving(create_app(settings, fake_house)) as client:
        yield client
