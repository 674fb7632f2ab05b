"""What the search knows and what it changes, as arrays: numbers only.

A *job* is one visit of one target; each way to do a job is a *node*. Nodes are numbered bases first, then job
after job. A *route* is one possible trip: those of a member follow one another, and of those that are used
none comes after one that is not.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Jobs(NamedTuple):
    """Jobs and their nodes.

    Attributes
    ----------
    first
        The nodes of job j are ``first[j] … first[j + 1] − 1``, (J + 1,).
    of
        The job of a node, −1 for bases, (N,).
    early, late
        Earliest start and latest end of a node's service, (N,); those of revisits change with the search.
    prize
        What leaving a job out costs, (J,).
    load
        What a job takes of an aircraft's capacity, (J,).
    near
        Jobs by nearness to each job, itself first, (J, J).
    keys
        Orders in which jobs are put back, least first, (K, J).
    after
        The job that is the visit before this one, or −1, (J,).
    apart
        Least time between that visit's end and this one's start, (J,).
    """

    first: Ints
    of: Ints
    early: Floats
    late: Floats
    prize: Floats
    load: Floats
    near: Ints
    keys: Floats
    after: Ints
    apart: Floats


class Costs(NamedTuple):
    """Travel by profile of aircraft, (P, N, N) each: service of the column's node is in all but ``seconds``.

    ``price`` is what the objective pays for an arc beside time. ``length`` and ``energy`` have one element
    where nothing limits them. ``seconds_to`` and ``price_to`` are (P, column, row), so that all that leads to
    one node lies together. ``service`` is (P, N), infinite where the profile cannot do the node.
    """

    seconds: Floats
    seconds_to: Floats
    service: Floats
    price: Floats
    price_to: Floats
    length: Floats
    energy: Floats


class Crew(NamedTuple):
    """Members of the fleet, (M,) each; ``limits`` are (M, 9), see the ``LIMIT`` numbers.

    ``first``: routes of member m are ``first[m] … first[m + 1] − 1``. ``ends_first`` and ``ends`` list the
    bases each may land at in the same way. ``twin``: members of one number are alike and start empty from one
    base.
    """

    profile: Ints
    start: Ints
    first: Ints
    ends_first: Ints
    ends: Ints
    twin: Ints
    limits: Floats


READY, SHIFT_END, FLIGHT, RANGE, ENERGY, WAITING, TURNAROUND, CAPACITY, IDLE = range(9)


class Weights(NamedTuple):
    """Of the objective."""

    time: float
    landing: float


class Routes(NamedTuple):
    """A solution: what the search changes. R routes of at most L jobs.

    Attributes
    ----------
    member
        Whose route it is, (R,).
    seq
        Nodes: the base, ``filled`` jobs, the base landed at, (R, L + 2).
    filled
        How many jobs, (R,).
    at
        The route of each job, −1 when left out, (J,).
    fore, back
        Least duration, earliest and latest start of the part up to, and from, each place, and the price of
        the arc that leads to it or from it, (R, L + 2, 4).
    sums
        Duration, landing, price, length, energy of travel and service, seconds in motion, load, (R, 7).
    """

    member: Ints
    seq: Ints
    filled: Ints
    at: Ints
    fore: Floats
    back: Floats
    sums: Floats


DURATION, LANDING, PRICE, LENGTH, USED, MOVING, LOAD = range(7)
