"""Turn the JSON lines of ``swathplan bench urban --json`` into the tables of docs/urban.md.

``swathplan bench urban --json | python -m benchmarks.urban_table``
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from typing import Any

#: What the other methods' figures are set against.
MEASURES = ("length_m", "turns", "overlap_m", "cpu_s")


def tables(rows: Iterable[dict[str, Any]]) -> str:
    """One table of all maps, and one of each method against each other in the mean over the maps."""
    listed = list(rows)
    methods = list(dict.fromkeys(row["method"] for row in listed))
    maps: dict[str, dict[str, dict[str, Any]]] = {}
    for row in listed:
        maps.setdefault(row["map"], {})[row["method"]] = row
    heads = " | ".join(f"{method}: length, m | turns | overlap, m | CPU s" for method in methods)
    lines = [f"| map | size, m | free | {heads} |", "| --- | --- | --- |" + " --- |" * (4 * len(methods))]
    for name, found in maps.items():
        first = next(iter(found.values()))
        cells = [name, first["size_m"], f"{first['free']:.2f}"]
        for method in methods:
            row = found[method]
            cells += [f"{row['length_m']:,.0f}", str(row["turns"]), f"{row['overlap_m']:,.0f}"]
            cells.append(f"{row['cpu_s']:.3f}")
        lines.append(f"| {' | '.join(cells)} |")
    lines += ["", f"| mean of | against | {' | '.join(MEASURES)} |"]
    lines.append("| --- | --- |" + " --- |" * len(MEASURES))
    for method in methods:
        for other in methods:
            if method == other:
                continue
            shares = [
                sum(found[method][key] / found[other][key] - 1.0 for found in maps.values()) / len(maps)
                for key in MEASURES
            ]
            lines.append(f"| {method} | {other} | {' | '.join(f'{100.0 * s:+.1f} %' for s in shares)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(tables(json.loads(line) for line in sys.stdin if line.strip()))
