"""Which algorithm each stage uses, by name."""

from __future__ import annotations

from planner.coverage.urban.methods import SEQUENCES
from planner.wishes import Method

#: What ``auto`` stands for.
AUTO = {
    "coverage": "sweeps",
    "routing": "joint",
    "transit": "tangent",
    "smoothing": "fillet",
    "search": "none",
}


def chosen_methods(method: Method) -> dict[str, str]:
    """The algorithm of each stage, ``auto`` resolved."""
    asked = {name: getattr(method, name) for name in Method.__slots__}
    chosen = {name: AUTO[name] if value == "auto" else value for name, value in asked.items()}
    if chosen["coverage"] in SEQUENCES:
        # Footprint sweeps come in an order of their own.
        chosen["routing"] = chosen["coverage"]
        return chosen
    if method.routing == "auto" and method.coverage == "li2018":
        # Asking for the paper's neighbourhoods by name means the paper's choice among them.
        chosen["routing"] = "li2018"
    if chosen["routing"] != "joint":
        # The paper's choices are among the paper's neighbourhoods.
        chosen["coverage"] = "li2018"
    return chosen
