"""Entries of the databases found by the names that clients write."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from typing import TypeVar

Entry = TypeVar("Entry")


def named(table: Mapping[str, Entry], name: str, kind: str, command: str) -> Entry:
    """An entry by its name, case aside.

    Parameters
    ----------
    kind, command
        What the entries are, and the command that lists them.

    Raises
    ------
    KeyError
        None is called so; its argument says which come near.
    """
    known = {each.casefold(): each for each in table}
    found = known.get(name.casefold())
    if found is None:
        near = [known[each] for each in get_close_matches(name.casefold(), known, n=3, cutoff=0.5)]
        hint = f"; near it: {', '.join(near)}" if near else f"; `{command}` lists them"
        raise KeyError(f"no {kind} is called {name!r}{hint}")
    return table[found]
