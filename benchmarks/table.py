"""Turn the JSON lines of ``swathplan bench sar --json`` into the tables of docs/benchmarks.md.

``swathplan bench sar --json | python -m benchmarks.table``
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from typing import Any

NAMES = {
    "auto": "auto",
    "li2018": "paper's stages",
    "zigzag-vertical": "vertical zigzag",
    "zigzag-horizontal": "horizontal zigzag",
}


def tables(rows: Iterable[dict[str, Any]]) -> str:
    """Markdown tables of the rows."""
    listed = list(rows)
    lines = [
        "| case | planner | RL, m | CL, m | DC, % | paper: RL, m | CL, m | DC, % | in threats, m "
        "| least coverage | tightest turn, m | gap to the bound, % | planned in, s | paper, s |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for row in (r for r in listed if r["bench"] == "sar"):
        own = [f"{row['rl_m']:,.0f}", f"{row['cl_m']:,.0f}", f"{row['dc_percent']:.1f}"]
        paper = [f"{row['paper_rl_m']:,.0f}", f"{row['paper_cl_m']:,.0f}", f"{row['paper_dc_percent']:.1f}"]
        checked = ["", "", "", "", "", ""]
        if "planning_s" in row:
            checked = [
                f"{row['metres_in_threats']:.0f}",
                f"{row['least_coverage']:.6f}",
                f"{row['min_turn_radius_m']:.2f}",
                "" if row["gap"] is None else f"{100.0 * row['gap']:.1f}",
                f"{row['planning_s']:.2f}",
                f"{row['paper_planning_s']:.1f}",
            ]
        lines.append(
            "| " + " | ".join([str(row["case"]), NAMES[row["planner"]], *own, *paper, *checked]) + " |"
        )
    lines += [
        "",
        "| case 1, sub-route | cost | time, ms | slowest, ms | nodes | paper's cost | paper's time, s |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for row in (r for r in listed if r["bench"] == "sar-subroute"):
        paper_cost = "" if row["paper_cost"] is None else f"{row['paper_cost']:.4f}"
        paper_s = "" if row["paper_runtime_s"] is None else f"{row['paper_runtime_s']:.2f}"
        lines.append(
            f"| s{row['subroute']} | {row['cost']:.4f} | {1000 * row['runtime_s']:.1f} "
            f"| {1000 * row['runtime_max_s']:.1f} | {row['nodes']} | {paper_cost} | {paper_s} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    print(tables(json.loads(line) for line in sys.stdin if line.strip()))
