"""A simulated radio between machine and vehicle: simulated time, seeded loss, duplication, reordering."""

from __future__ import annotations

import heapq
import itertools
import math
from dataclasses import dataclass, replace
from random import Random
from typing import Any

from mavlink.transfer.machine import Machine
from mavlink.wire.messages import Message
from tests.mavlink.transfer.vehicle import GROUND, StubVehicle

_LONGEST_DETOUR_S = 0.4


@dataclass(frozen=True, slots=True)
class Weather:
    """Chances for each message, and the time one way."""

    loss: float = 0.0
    duplication: float = 0.0
    reordering: float = 0.0
    seed: int = 0
    latency_s: float = 0.02


class Air:
    """Carries messages until the machine has its outcome, and then what is still on its way."""

    def __init__(self, machine: Machine[Any], vehicle: StubVehicle, weather: Weather = Weather()) -> None:
        self.now_s = 0.0
        self._machine = machine
        self._vehicle = vehicle
        self._weather = weather
        self._random = Random(weather.seed)
        self._order = itertools.count()
        self._flying: list[tuple[float, int, bool, Message]] = []

    def run(self) -> None:
        """Run the transfer to its end and let the air clear."""
        self._send(self._machine.start(self.now_s), to_vehicle=True)
        while True:
            arrival_s = self._flying[0][0] if self._flying else math.inf
            next_s = min(arrival_s, self._machine.deadline_s, self._vehicle.deadline_s)
            if next_s == math.inf:
                return
            assert next_s < 100_000.0, "the transfer does not end"
            self.now_s = max(self.now_s, next_s)
            if self._flying and arrival_s <= self.now_s:
                _, _, to_vehicle, message = heapq.heappop(self._flying)
                receiver = self._vehicle if to_vehicle else self._machine
                self._send(receiver.receive(message, self.now_s), not to_vehicle)
            self._send(self._machine.tick(self.now_s), to_vehicle=True)
            self._send(self._vehicle.tick(self.now_s), to_vehicle=False)

    def _send(self, messages: list[Message], to_vehicle: bool) -> None:
        for message in messages:
            if to_vehicle:
                message = replace(message, system_id=GROUND[0], component_id=GROUND[1])
            if self._random.random() < self._weather.loss:
                continue
            copies = 2 if self._random.random() < self._weather.duplication else 1
            for _ in range(copies):
                detour = self._random.random() < self._weather.reordering
                delay_s = self._weather.latency_s + (
                    self._random.random() * _LONGEST_DETOUR_S if detour else 0.0
                )
                heapq.heappush(self._flying, (self.now_s + delay_s, next(self._order), to_vehicle, message))
