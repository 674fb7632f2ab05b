"""Scenarios changed in their structure: judged, and nothing else."""

from __future__ import annotations

import json
import random
import time
from pathlib import Path

from app.services.scenarios.validation import judge
from tests.app.imports.mutations import of_json

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
#: A radar's passes, a camera's survey, several aircraft with windows, a search with drift, an island.
SEEDS = ("sar-case-1", "field-survey", "port-windows", "three-aircraft", "missing-at-sea", "island-volcano")
RUNS = 2000
#: Of the processor, so that a busy machine makes no difference.
MOST_S = 2.0


def test_mutated_scenarios_are_judged() -> None:
    """Members gone, doubled, wrapped, exchanged, of other types: findings with rule and fix, and soon."""
    dice = random.Random(9)
    seeds = [(EXAMPLES / f"{name}.geojson").read_bytes() for name in SEEDS]
    refused = longest = 0.0
    for _ in range(RUNS):
        document = json.loads(of_json(dice.choice(seeds), dice))
        began_s = time.process_time()
        verdict = judge(document)
        longest = max(longest, time.process_time() - began_s)
        assert all(finding.rule and finding.fix for finding in verdict.errors), document
        refused += bool(verdict.errors)
    assert 0 < refused < RUNS
    assert longest < MOST_S
