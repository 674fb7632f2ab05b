"""``swathplan aircraft`` lists airframes, and so does the service."""

import json

import httpx
import pytest
from typer.testing import CliRunner

from app.cli.root import cli
from planner.vehicle.airframes import AIRFRAMES


def told(*arguments):
    """What the command prints."""
    result = CliRunner().invoke(cli, ["aircraft", *arguments], catch_exceptions=False)
    assert result.exit_code == 0
    return result.stdout


def test_it_lists_every_airframe():
    """In words and as JSON, with times that keep the reserve."""
    assert all(name in told() for name in AIRFRAMES)
    rows = json.loads(told("--json"))
    assert [row["name"] for row in rows] == list(AIRFRAMES)
    one = json.loads(told("DJI Matrice 300 RTK", "--json"))
    assert one["flight_time_s"] == pytest.approx(0.8 * 548.0 / one["cruise_power_w"] * 3600.0, abs=2.0)


def test_unknown_ones_are_told():
    """The exit code says so, and what is near."""
    result = CliRunner().invoke(cli, ["aircraft", "DJI Phantom 5"])
    assert result.exit_code != 0


async def test_the_service_lists_the_same(client: httpx.AsyncClient) -> None:
    """By words of name and type."""
    found = (await client.get("/api/v1/aircraft")).json()["aircraft"]
    assert [each["name"] for each in found] == list(AIRFRAMES)
    wings = (await client.get("/api/v1/aircraft", params={"search": "FIXED_wing"})).json()["aircraft"]
    assert {each["vehicle"]["type"] for each in wings} == {"fixed_wing"}
