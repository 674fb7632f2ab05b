"""A thousand uploads over a radio that loses a fifth of everything: nothing untrue is said of any."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass, replace
from random import Random

import pytest

from mavlink.transfer.download import DownloadMachine
from mavlink.transfer.outcome import Accepted, Outcome, Refused
from mavlink.transfer.upload import UploadMachine
from mavlink.wire.items import MissionResult, MissionType
from tests.mavlink.transfer.air import Air, Weather
from tests.mavlink.transfer.vehicle import StubVehicle, waypoints

ITEMS = waypoints(600)


@dataclass(frozen=True)
class Ending:
    """How one upload ended, and whether it was right to say so."""

    outcome: Outcome
    true: bool
    resolved: bool


def _length(random: Random, most: int) -> int:
    """From 1 to the most, each order of magnitude as often as another."""
    return round(most ** random.random())


def storm(seed: int, loss: float, most: int, refusing: bool) -> Ending:
    """One upload of a random length onto a random old mission, then a read-back in the same weather."""
    random = Random(seed)
    items = ITEMS[: _length(random, most)]
    manner = random.choice(["ardupilot", "px4"])
    refused = {random.randrange(len(items)): MissionResult.INVALID_PARAM2} if refusing else {}
    vehicle = StubVehicle(manner, refused)
    vehicle.held[0] = old = ITEMS[: _length(random, most) - 1]
    machine = UploadMachine(items, MissionType.MISSION, 1, 1)
    Air(machine, vehicle, Weather(loss, 0.05, 0.05, seed)).run()
    for again in range(3):  # as mavlink.station.verify does
        download = DownloadMachine(MissionType.MISSION, 1, 1)
        Air(download, vehicle, Weather(loss, 0.05, 0.05, 1_000_000 + 3 * seed + again)).run()
        if download.outcome == Accepted():
            break
    outcome = machine.outcome
    assert outcome is not None
    if isinstance(outcome, Accepted):
        true = vehicle.held[0] == items
    elif isinstance(outcome, Refused):
        true = outcome.result in vehicle.said and not (manner == "px4" and vehicle.held[0] != old)
    else:
        true = True  # unknown claims nothing; the read-back tells
    if download.outcome == Accepted():
        true &= download.items == vehicle.held[0]
    return Ending(outcome, true, download.outcome == Accepted())


@pytest.mark.parametrize("chunk", range(10))
def test_a_thousand_uploads_in_a_storm(chunk: int) -> None:
    """1 to 600 items, 20 % loss, 5 % doubled, 5 % overtaken, each way: every outcome is true, none hangs."""
    endings = [storm(1000 * chunk + number, 0.2, 600, refusing=False) for number in range(100)]
    assert all(ending.true for ending in endings)
    accepted = sum(isinstance(ending.outcome, Accepted) for ending in endings)
    known = sum(isinstance(ending.outcome, Accepted) or ending.resolved for ending in endings)
    assert accepted >= 65
    assert known >= 90


@pytest.mark.parametrize("loss", [0.0, 0.2, 0.5])
def test_a_refusal_is_never_taken_for_acceptance(loss: float) -> None:
    """A vehicle that refuses one item of a list is never said to have accepted it, whatever is lost."""
    for seed in range(60):
        ending = storm(seed, loss, 40, refusing=True)
        assert ending.true
        assert not isinstance(ending.outcome, Accepted)


def test_a_third_lost_on_a_slow_link() -> None:
    """With 30 % lost and 0.4 s each way most missions get through; of the others nothing untrue is said."""
    weather = Weather(0.3, 0.0, 0.0, latency_s=0.4)
    known = 0
    for seed in range(40):
        vehicle = StubVehicle("px4" if seed % 2 else "ardupilot")
        machine = UploadMachine(ITEMS[:40], MissionType.MISSION, 1, 1)
        air = Air(machine, vehicle, replace(weather, seed=seed))
        air.run()
        assert air.now_s < 600.0
        outcome = machine.outcome
        assert outcome is not None
        if isinstance(outcome, Accepted):
            assert vehicle.held[0] == ITEMS[:40]
        elif isinstance(outcome, Refused):
            assert outcome.result in vehicle.said  # a vehicle that hears nothing gives up and says so
        for again in range(3):
            download = DownloadMachine(MissionType.MISSION, 1, 1)
            Air(download, vehicle, replace(weather, seed=1000 + 3 * seed + again)).run()
            if download.outcome == Accepted():
                assert download.items == vehicle.held[0]
                known += download.items == ITEMS[:40]
                break
    assert known >= 25


def main() -> None:
    """Print how the thousand uploads ended."""
    counts: Counter[str] = Counter()
    for seed in range(1000):
        ending = storm(1000 * (seed // 100) + seed % 100, 0.2, 600, refusing=False)
        settled = ", settled by read-back" if ending.resolved else ""
        counts[("" if ending.true else "UNTRUE ") + ending.outcome.kind + settled] += 1
    for name, count in sorted(counts.items()):
        sys.stdout.write(f"{count:5d} {name}\n")


if __name__ == "__main__":
    main()
