"""What a service does with a process that holds the links already."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.services.errors import LinkError
from app.services.links import keeper as keeping
from app.services.links.client import LinksState
from app.services.links.keeper import Keeper
from app.services.links.place import Holder, Lock, place_of


class Process:
    """Stands for the process: holds the lock, and notes what is done with it."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.place = place_of(folder / "plans.db")
        self.lock: Lock | None = Lock(self.place, Holder(os.getpid(), "1.0", "old"))
        self.in_use: tuple[str, ...] = ()
        self.done: list[str] = []
        self._monkeypatch = monkeypatch

    def keeper(self, fingerprint: str, *, keep: bool = False) -> Keeper:
        """A keeper that wants a process of a kind."""
        kept = Keeper(self.place, "{}", "1.0", fingerprint, keep=keep)

        async def state() -> LinksState:
            if self.lock is None:
                raise LinkError("nobody is there")
            return LinksState(os.getpid(), 1, self.in_use)

        async def start() -> None:
            self.done.append("started")
            self.lock = Lock(self.place, Holder(os.getpid(), "1.0", fingerprint))

        async def end(place: object) -> None:
            self.done.append("ended")
            self.free()

        self._monkeypatch.setattr(kept.client, "state", state)
        self._monkeypatch.setattr(kept, "_start", start)
        self._monkeypatch.setattr(keeping, "end_holder", end)
        return kept

    def free(self) -> None:
        """Give the lock up."""
        if self.lock is not None:
            self.lock.release()
            self.lock = None


@pytest.fixture
def process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Process]:
    """A process that was started with some settings."""
    there = Process(tmp_path, monkeypatch)
    yield there
    there.free()


@pytest.mark.parametrize(
    ("fingerprint", "in_use", "done"),
    [
        ("old", (), []),
        ("old", ("uav",), []),
        ("new", (), ["ended", "started"]),
        ("new", ("uav",), []),
    ],
)
async def test_a_process_of_other_settings_is_begun_anew_unless_in_use(
    process: Process, fingerprint: str, in_use: tuple[str, ...], done: list[str]
) -> None:
    """The one that is there is taken over; where it should be another it is ended first, not in flight."""
    process.in_use = in_use
    keeper = process.keeper(fingerprint)
    await keeper.open()
    assert process.done == done
    await keeper.close()
    await keeper.close()


async def test_nobody_there_is_started(process: Process) -> None:
    """A lock that nobody holds any more, with its last holder in it, is no process."""
    process.free()
    keeper = process.keeper("new")
    await keeper.open()
    assert process.done == ["started"]
    await keeper.close()


@pytest.mark.parametrize(
    ("keep", "in_use", "done"),
    [(False, (), ["ended"]), (True, (), []), (False, ("uav",), [])],
)
async def test_an_orderly_end_leaves_what_is_in_use_or_to_be_kept(
    process: Process, keep: bool, in_use: tuple[str, ...], done: list[str]
) -> None:
    """It ends with the service but while a vehicle is armed, or where that is wished for."""
    keeper = process.keeper("old", keep=keep)
    await keeper.open()
    process.in_use = in_use
    await keeper.close()
    assert process.done == done
