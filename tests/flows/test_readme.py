"""What the README shows is true."""

from __future__ import annotations

import json
import re
from pathlib import Path

from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    """Fenced blocks of one language."""
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_the_smallest_scenario_plans() -> None:
    """The scenario in the README plans without violations."""
    (document,) = (json.loads(text) for text in blocks("json"))
    plan = make_plan(read_scenario(document))
    assert plan.violations == ()
    assert plan.metrics.coverage == {"R1": 1.0}


def test_the_library_snippet_runs() -> None:
    """The lines of Python in the README run on a scenario document."""
    (document,) = (json.loads(text) for text in blocks("json"))
    (snippet,) = blocks("python")
    names: dict[str, object] = {"document": document}
    exec(snippet, names)
    assert write_plan(names["plan"])["violations"] == []  # type: ignore[arg-type]


def test_files_it_names_are_there() -> None:
    """Every relative link of the README leads to a file."""
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        if not target.startswith("http"):
            assert (ROOT / target).exists(), target


def test_its_make_targets_are_there() -> None:
    """Every `make` command of the README is a target."""
    makefile = (ROOT / "Makefile").read_text()
    for target in set(re.findall(r"(?:^|`)make ([a-z0-9-]+)", README, flags=re.MULTILINE)):
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE), target
