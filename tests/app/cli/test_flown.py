"""``swathplan flown``: lines for people, and refusals in words."""

from __future__ import annotations

import json

from typer.testing import CliRunner

from app.cli.flown import summary
from app.cli.output import CommandError
from app.cli.root import cli
from app.services.flights.seen import Flown, Sortie, coverage_of
from app.settings import Settings
from planner.geojson import write_plan
from tests.app.cli.test_audit import serving
from tests.app.services.flights.test_photo_flight import flight_record, recorded
from tests.planner.as_flown.test_photos import asked, planned


def test_what_photos_saw_is_told_in_lines() -> None:
    """Fractions, photos and overlaps of a flight that lost some."""
    _, plan = planned()
    samples, events = recorded(plan, lost=True)
    flight = Flown(flight_record(plan), tuple(samples), tuple(events), tuple(events))
    sortie = Sortie("plan", json.dumps(write_plan(plan)), json.dumps(asked()), (flight,), None)
    report = coverage_of(sortie)
    lines = summary(report)
    lost = 5 * len(plan.photos)
    seen = report["coverage"]["A"]
    assert 0.5 < seen < 1.0
    assert lines[0].startswith(f"A: seen {100.0 * seen:.2f}%")
    assert lines[1].endswith(f"{lost} missing")
    assert "side" in lines[2]


def test_refusals_are_told(settings: Settings) -> None:
    """An unknown flight in the service's words; a plan has no track."""
    unknown = "00000000-0000-0000-0000-000000000000"
    with serving(settings) as address:
        ended = CliRunner().invoke(cli, ["flown", unknown, "--as", "overlap", "--service", address])
    assert isinstance(ended.exception, CommandError)
    assert "flight" in str(ended.exception)
    ended = CliRunner().invoke(cli, ["flown", unknown, "--plan", "--as", "track"])
    assert isinstance(ended.exception, CommandError)
    assert "without --plan" in str(ended.exception)
