"""Random assignment problems of fleets, for the benchmark and for tests."""

from __future__ import annotations

import numpy as np

from planner.fleet.problem import Alternative, Member, Objective, Problem, Service, Target, Travel


def case(
    seed: int,
    targets: int = 5,
    members: int = 2,
    alternatives: int = 2,
    bases: int = 1,
    windows: float = 0.5,
    required: float = 1.0,
    objective: Objective | None = None,
    **limits: float,
) -> Problem:
    """Targets strewn over 10 km, some with windows; ``limits`` are members' fields."""
    rng = np.random.default_rng(seed)
    counts = rng.integers(1, alternatives + 1, targets)
    nodes = bases + int(counts.sum())
    owner = np.repeat(np.arange(targets), counts)
    entry = rng.uniform(0.0, 10_000.0, (targets, 2))[owner] + rng.normal(0.0, 600.0, (len(owner), 2))
    exit_ = entry + rng.normal(0.0, 500.0, entry.shape)
    home = rng.uniform(0.0, 10_000.0, (bases, 2))
    leave, reach = np.vstack([home, exit_]), np.vstack([home, entry])
    length = np.hypot(*(leave[:, None, :] - reach[None, :, :]).transpose(2, 0, 1))
    fleet = []
    for number in range(members):
        speed = float(rng.uniform(18.0, 30.0))
        travel = Travel(
            length / speed * rng.uniform(1.0, 1.2, (nodes, nodes)), length, length * 0.02, length * 0.001
        )
        ends = tuple(range(bases))
        fleet.append(Member(f"a{number}", travel, number % bases, ends, **limits))  # type: ignore[arg-type]
    able = rng.uniform(size=(len(owner), members)) < 0.85
    todo, at = [], 0
    for number, count in enumerate(counts):
        ways = []
        for way in range(count):
            seconds = rng.uniform(10.0, 60.0, members)
            services = tuple(
                Service(float(seconds[m]), float(seconds[m] * 20), float(seconds[m] * 0.4))
                if able[at, m] or way == 0
                else None
                for m in range(members)
            )
            ways.append(Alternative(f"w{way}", services))
            at += 1
        opens = float(rng.uniform(0.0, 1500.0))
        window = (opens, opens + float(rng.uniform(300.0, 2000.0))) if rng.uniform() < windows else None
        needed = bool(rng.uniform() < required)
        todo.append(Target(f"t{number}", tuple(ways), float(rng.integers(1, 10)), needed, window))
    return Problem(tuple(f"b{i}" for i in range(bases)), tuple(todo), tuple(fleet), objective or Objective())
