"""Which algorithm each stage uses, by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from planner.coverage.urban.methods import SEQUENCES
from planner.transit.milp.values import Goal
from planner.wishes import Method

#: What ``auto`` stands for.
AUTO = {
    "coverage": "sweeps",
    "routing": "joint",
    "transit": "tangent",
    "smoothing": "fillet",
    "search": "none",
}

#: The programs of ``transit``, by what each makes least (eq 34, eq 47 of Stecz and Gromada 2020).
GOALS: Mapping[str, Goal] = MappingProxyType({"milp": "control", "milp-length": "length"})


def chosen_methods(method: Method) -> dict[str, str]:
    """The algorithm of each stage, ``auto`` resolved."""
    asked = {name: getattr(method, name) for name in AUTO}
    chosen = {name: AUTO[name] if value == "auto" else value for name, value in asked.items()}
    if chosen["transit"] in GOALS:
        chosen["directions"] = str(method.directions)
    if chosen["coverage"] in SEQUENCES:
        # Footprint sweeps come in an order of their own.
        chosen["routing"] = chosen["coverage"]
        return chosen
    if method.routing == "auto" and method.coverage == "li2018":
        # Asking for the paper's neighbourhoods by name means the paper's choice among them.
        chosen["routing"] = "li2018"
    if chosen["routing"] == "stecz2020":
        # The model says who does what in which order; the passes of a flight are chosen as ever.
        chosen["routing"] = AUTO["routing"]
    if chosen["routing"] != "joint":
        # The paper's choices are among the paper's neighbourhoods.
        chosen["coverage"] = "li2018"
    return chosen
