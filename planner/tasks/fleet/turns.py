"""In which order flights are put on the clock: each waits for those placed before it."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

import numpy as np

#: Of up to so many flights all orders are tried; of more so many others.
MOST_IN_ALL_ORDERS, ORDERS = 4, 60


def other_orders(members: Sequence[int], seed: int) -> list[tuple[int, ...]]:
    """Orders other than the one given, in which the flights of each aircraft come as they do in that one.

    Parameters
    ----------
    members
        Whose each flight is.

    Returns
    -------
    list
        Numbers of the flights, each order once.
    """
    if len(members) <= MOST_IN_ALL_ORDERS:
        turns: Iterable[Sequence[int]] = itertools.permutations(range(len(members)))
    else:
        rng = np.random.default_rng(seed)
        turns = [rng.permutation(len(members)).tolist() for _ in range(ORDERS)]
    found: dict[tuple[int, ...], None] = {}
    for turn in turns:
        own = {member: iter([k for k, each in enumerate(members) if each == member]) for member in members}
        found[tuple(next(own[members[k]]) for k in turn)] = None
    found.pop(tuple(range(len(members))), None)
    return list(found)
