"""What a plan's record tells without the plan itself."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

MEMBERS = ("metrics", "violations", "methods", "scenario_hash", "planner_version", "seed")


def summary_of(document: Mapping[str, Any]) -> dict[str, Any]:
    """The foreign members of a plan document that its record repeats."""
    return {name: document[name] for name in MEMBERS if name in document}
