"""What of the order that was being flown a plan made in flight has kept."""

from __future__ import annotations

from collections.abc import Sequence

from planner.plan import Plan, Replanned
from planner.scenario import Scenario
from planner.wishes import GoingOn, Unflown


def replanned(going_on: GoingOn, plan: Plan) -> Replanned:
    """What is kept, moved and new of what a plan sees."""
    now = order_of(plan)
    kept = {
        region
        for name, order in now.items()
        for region in _longest_common(going_on.order.get(name, ()), order)
    }
    old = {region for order in going_on.order.values() for region in order}
    seen = list(dict.fromkeys(region for order in now.values() for region in order))
    return Replanned(
        going_on.begins_in_s,
        tuple(region for region in seen if region in kept),
        tuple(region for region in seen if region in old and region not in kept),
        tuple(region for region in seen if region not in old),
        going_on.unless_better,
    )


def order_of(plan: Plan, after_s: float = 0.0) -> dict[str, tuple[str, ...]]:
    """By aircraft, regions in the order that they are seen in after a time; those over by then first."""
    in_turn = sorted(plan.collects, key=lambda each: (each.vehicle, each.start_s))
    left = {(each.vehicle, name) for each in in_turn if each.end_s > after_s for name in each.regions}
    found: dict[str, dict[str, None]] = {}
    for collect in in_turn:
        own = found.setdefault(collect.vehicle, {})
        done = collect.end_s <= after_s
        own.update(
            (name, None) for name in collect.regions if not done or (collect.vehicle, name) not in left
        )
    return {name: tuple(regions) for name, regions in found.items()}


def unflown_of(scenario: Scenario, plan: Plan, after_s: float) -> dict[str, tuple[Unflown, ...]]:
    """By aircraft, the passes that are flown after a time, of one being flown then what is left of it."""
    found: dict[str, list[Unflown]] = {}
    for collect in sorted(plan.collects, key=lambda each: (each.vehicle, each.start_s)):
        if collect.end_s <= after_s:
            continue
        begin, end = scenario.frame.to_local([place[:2] for place in collect.line])
        done = max(after_s - collect.start_s, 0.0) / (collect.end_s - collect.start_s)
        (east_m, north_m), (east_to_m, north_to_m) = (begin + done * (end - begin)).tolist(), end.tolist()
        one = Unflown((east_m, north_m), (east_to_m, north_to_m), collect.look)
        found.setdefault(collect.vehicle, []).append(one)
    return {name: tuple(passes) for name, passes in found.items()}


def _longest_common(one: Sequence[str], other: Sequence[str]) -> list[str]:
    """The longest order that both have in them."""
    longest: list[list[list[str]]] = [[[] for _ in range(len(other) + 1)] for _ in range(len(one) + 1)]
    for i, a in enumerate(one):
        for j, b in enumerate(other):
            without = max(longest[i][j + 1], longest[i + 1][j], key=len)
            longest[i + 1][j + 1] = [*longest[i][j], a] if a == b else without
    return longest[-1][-1]
