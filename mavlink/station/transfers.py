"""A ground station's transfers with one vehicle: lists up and down, read back and compared."""

from __future__ import annotations

import asyncio
import contextlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Final

from mavlink.errors import NotConnectedError, TransferFailedError, UnsupportedError
from mavlink.state.telemetry import VehicleState
from mavlink.station.driver import Driver
from mavlink.station.verify import (
    Compare,
    Pending,
    VerifiedUpload,
    resolve,
    update_and_verify,
    upload_and_verify,
)
from mavlink.transfer.clear import ClearMachine, SetCurrentMachine, flown_for
from mavlink.transfer.count import CountMachine
from mavlink.transfer.download import DownloadMachine
from mavlink.transfer.machine import Progress, TransferSettings
from mavlink.transfer.outcome import Accepted, Outcome, Unknown
from mavlink.transfer.partial import PartialUpdateMachine
from mavlink.transfer.upload import UploadMachine
from mavlink.wire.items import MissionItem, MissionType

# PX4 judges a mission within moments of its acknowledgement, and gives its reasons one by one.
_JUDGEMENT_S: Final = 1.0
_MORE_REASONS_S: Final = 0.2


class MissionTransfers(ABC):
    """The transfers, on top of a driver that carries them."""

    _driver: Driver
    _settings: TransferSettings
    _clock: Callable[[], float]

    def __init__(self) -> None:
        self._forget_lists()

    def _forget_lists(self) -> None:
        """Nothing is known of what the vehicle holds."""
        self._pending: Pending | None = None
        self._read_id: int | None = None
        self._read_mission: tuple[int, tuple[MissionItem, ...]] | None = None
        self._rejected: tuple[tuple[MissionItem, ...], tuple[str, ...]] | None = None

    @property
    @abstractmethod
    def state(self) -> VehicleState:
        """All that is known of the vehicle now."""

    @abstractmethod
    async def wait_for(self, condition: Callable[[VehicleState], bool], timeout_s: float) -> VehicleState:
        """Wait until the state meets a condition. Raises TimeoutError, or NotConnectedError at the end."""

    @abstractmethod
    def _target(self) -> tuple[int, int]:
        """System and component to talk to. Raises NotConnectedError while there is none."""

    @property
    def absence(self) -> str:
        """Why a vehicle that is not connected cannot be talked to."""
        return self._driver.absence

    def adopt(self, system_id: int) -> None:
        """Take the aircraft heard in the vehicle's place for the vehicle: nothing is known of it yet.

        Parameters
        ----------
        system_id
            As ``state.other_system`` has it. It connects with its next heartbeat.

        Raises
        ------
        NotConnectedError
            It is not heard there.
        """
        self._driver.adopt(system_id)
        self._forget_lists()

    def acknowledge(self, address: str) -> None:
        """Take an address heard on the vehicle's port for the vehicle's: nothing is known of what it holds.

        Parameters
        ----------
        address
            As ``state.strangers`` or ``state.address`` has it.

        Raises
        ------
        NotConnectedError
            Nobody was heard from there lately.
        """
        self._driver.acknowledge(address)
        self._forget_lists()

    async def upload(
        self,
        items: Sequence[MissionItem],
        mission_type: MissionType,
        progress: Callable[[Progress], None] | None = None,
    ) -> Outcome:
        """Upload without reading back.

        Raises BusyError, DoubtError, NotConnectedError, CodecError, ValueError.
        """
        return await self._send(UploadMachine(items, mission_type, *self._target(), self._settings), progress)

    async def update(
        self, items: Sequence[MissionItem], progress: Callable[[Progress], None] | None = None
    ) -> Outcome:
        """Put these in the place of the mission's items of their numbers, without reading back.

        Raises
        ------
        UnsupportedError
            Only ArduPilot does it.
        BusyError, NotConnectedError, CodecError, ValueError
            Nothing was begun.
        """
        machine = PartialUpdateMachine(items, *self._target(), self._settings)
        if self.state.autopilot != "ardupilot":
            raise UnsupportedError("this autopilot takes no partial update: upload whole")
        return await self._send(machine, progress)

    async def _send(self, machine: UploadMachine, progress: Callable[[Progress], None] | None) -> Outcome:
        ids, kind = self._driver.list_ids, machine.mission_type
        self._driver.require_certain()
        self._driver.require_free()
        with self.reserved(changes=True):
            self._forget(kind)
            ids.sending(kind, self.state)
            try:
                outcome = await self._driver.transfer(machine, progress)
            finally:
                self._driver.list_changed(kind)
            return ids.sent(kind, outcome, machine.opaque_id, self.state)

    def reserved(self, *, changes: bool) -> AbstractContextManager[None]:
        """Keep the vehicle's lists to this station over several transfers, each of which does so by itself.

        Parameters
        ----------
        changes
            Whether they change what the vehicle holds: other stations' orders to fly it are held back too.

        Raises
        ------
        BusyError
            Another ground station that the link is forwarded to is at work on them.
        """
        return self._driver.reserved(changes=changes)

    async def download(
        self, mission_type: MissionType, progress: Callable[[Progress], None] | None = None
    ) -> tuple[MissionItem, ...]:
        """What the vehicle holds. Raises TransferFailedError, BusyError, NotConnectedError."""
        machine = DownloadMachine(mission_type, *self._target(), self._settings)
        with self.reserved(changes=False):
            outcome = await self._driver.transfer(machine, progress)
        if outcome.kind != "accepted":
            raise TransferFailedError(f"download of the {mission_type.name.lower()}", outcome)
        self._read_id = machine.opaque_id
        if mission_type is MissionType.MISSION:
            self._read_mission = self._driver.epoch, machine.items
        return machine.items

    @property
    def _held_mission(self) -> tuple[MissionItem, ...] | None:
        """The mission as read last, unless the vehicle was lost, restarted or replaced since."""
        if self._read_mission is None or self._read_mission[0] != self._driver.epoch:
            return None
        return self._read_mission[1]

    @property
    def mission_known(self) -> tuple[MissionItem, ...] | None:
        """The mission as far as it is known without asking; None where it would have to be read."""
        return self._held_mission

    async def count_held(self) -> tuple[int, int | None]:
        """How many items the vehicle's mission has, and the vehicle's id of it; None where it gives none.

        Raises
        ------
        TransferFailedError, BusyError, NotConnectedError
            It was not told.
        """
        machine = CountMachine(MissionType.MISSION, *self._target(), self._settings)
        with self.reserved(changes=False):
            outcome = await self._driver.transfer(machine)
        if outcome.kind != "accepted":
            raise TransferFailedError("asking for the number of items", outcome)
        return machine.count, machine.opaque_id

    async def mission_held(self, *, anew: bool = False) -> tuple[MissionItem, ...]:
        """The mission as read last, or read now where it was not, or is not to be believed any more.

        Raises
        ------
        TransferFailedError, BusyError, NotConnectedError
            It could not be read.
        """
        known = self._held_mission
        return await self.download(MissionType.MISSION) if known is None or anew else known

    async def clear(self, mission_type: MissionType) -> Outcome:
        """Empty one of the vehicle's lists. Raises BusyError, DoubtError, NotConnectedError."""
        machine = ClearMachine(mission_type, *self._target(), self._settings)
        self._driver.require_certain()
        self._driver.require_free()
        with self.reserved(changes=True):
            self._forget(mission_type)
            self._driver.list_ids.sending(mission_type, self.state)
            try:
                return await self._driver.transfer(machine)
            finally:
                self._driver.list_changed(mission_type)

    def _forget(self, mission_type: MissionType) -> None:
        """What was read of a list no longer counts: it is being changed."""
        if mission_type is MissionType.MISSION:
            self._read_mission = None

    async def set_current(self, seq: int) -> Outcome:
        """Make an item the one flown next. Raises BusyError, NotConnectedError.

        Sent to an item that is no place to fly to, a vehicle goes on to the next that is, and reports that
        one; so does ArduPilot sent to its home row, 0, which begins the mission anew. Which it is the mission
        tells: as last read, or else read when the answer leaves it open.
        """
        known = self._held_mission
        first = seq + 1 if seq == 0 and self.state.autopilot == "ardupilot" else seq
        answers = frozenset[int]() if known is None else flown_for(known, first)
        machine = SetCurrentMachine(seq, *self._target(), self._settings, answers)
        with self.reserved(changes=False):
            outcome = await self._driver.transfer(machine)
        if known is None and machine.reported and outcome == Unknown("timeout"):
            with contextlib.suppress(TransferFailedError, NotConnectedError):
                if machine.reported & flown_for(await self.download(MissionType.MISSION), first):
                    return Accepted()
        return outcome

    async def upload_verified(
        self,
        items: Sequence[MissionItem],
        mission_type: MissionType,
        differences: Compare,
        progress: Callable[[Progress], None] | None = None,
    ) -> VerifiedUpload:
        """Upload, read back and compare; an unknown outcome is resolved by what is read back.

        Parameters
        ----------
        differences
            ``differences(meant, held)``: what differs, empty when the vehicle holds what was meant.

        Raises
        ------
        BusyError, NotConnectedError, CodecError, ValueError
            Nothing was begun.
        """
        begun_s = self._clock()
        with self.reserved(changes=True):
            result = await upload_and_verify(self, items, mission_type, differences, progress)
        self._conclude(Pending(tuple(items), mission_type, differences, result.outcome), result)
        judged = mission_type in (MissionType.MISSION, MissionType.FENCE) and self._driver.events.heard
        if judged and result.status == "stored":
            result = replace(result, objections=await self._objections(tuple(items), begun_s))
        return result

    async def update_items(
        self,
        items: Sequence[MissionItem],
        changed: range,
        differences: Compare,
        progress: Callable[[Progress], None] | None = None,
    ) -> VerifiedUpload:
        """Replace a range of the items the vehicle holds, read the whole mission back and compare.

        The other items stay untouched: nothing is cut, and an aircraft that flies the mission goes on.

        Parameters
        ----------
        items
            The whole mission as it shall be, home row included.
        changed
            Numbers of the items to send, e.g. ``range(7, 9)`` for 7 and 8; all others are only compared.
        differences
            ``differences(meant, held)``: what differs, empty when the vehicle holds what was meant.

        Raises
        ------
        UnsupportedError
            The autopilot takes no partial update (PX4 ignores it): upload the whole mission.
        BusyError, NotConnectedError, CodecError, ValueError
            Nothing was begun.
        """
        if changed.step != 1 or not 0 <= changed.start < changed.stop <= len(items):
            raise ValueError(f"{changed} names no run of the mission's {len(items)} items")
        with self.reserved(changes=True):
            result = await update_and_verify(self, items, changed, differences, progress)
        self._conclude(Pending(tuple(items), MissionType.MISSION, differences, result.outcome), result)
        return result

    def _conclude(self, pending: Pending, result: VerifiedUpload) -> None:
        """Keep what is not resolved for later; what is held as meant is known by its id from now on."""
        self._pending = pending if result.held is None else None
        if result.status == "stored":
            self._driver.list_ids.read(pending.mission_type, self._read_id)

    @property
    def replaced(self) -> frozenset[MissionType]:
        """Lists that are others than those uploaded from here, by the ids the vehicle reports.

        A sign only, and none from vehicles without ids: a download tells.
        """
        return self._driver.list_ids.replaced

    def recognise(self, mission_type: MissionType) -> None:
        """Take the list read last for the one meant: from now on its id tells whether it is replaced."""
        self._driver.list_ids.read(mission_type, self._read_id)

    def sent_id(self, mission_type: MissionType) -> int | None:
        """The id the vehicle gave the list sent from here; None where it gives none, or none was sent."""
        return self._driver.list_ids.meant(mission_type)

    async def _objections(self, items: tuple[MissionItem, ...], begun_s: float) -> tuple[str, ...]:
        """What a vehicle that speaks in events says against its mission, having just taken this list."""

        def said(state: VehicleState) -> tuple[str, ...]:
            against = (text for text in state.texts if text.against_mission and text.heard_s >= begun_s)
            return tuple(dict.fromkeys(text.text for text in against))

        try:
            await self.wait_for(lambda state: bool(said(state)), _JUDGEMENT_S)
            await asyncio.sleep(_MORE_REASONS_S)
        except (TimeoutError, NotConnectedError):
            # It has nothing against it; or it is the list it holds already, which it does not judge again.
            if self._rejected is not None and self._rejected[0] == items:
                return self._rejected[1]
        objections = said(self.state)
        self._rejected = (items, objections) if objections else None
        return objections

    @property
    def pending(self) -> bool:
        """True while an upload's outcome waits for ``resolve_pending``."""
        return self._pending is not None

    async def resolve_pending(self) -> VerifiedUpload | None:
        """Read back what an upload that ended as unknown left; None when there is nothing to resolve.

        Raises
        ------
        BusyError, NotConnectedError
            Not now; it stays pending.
        """
        if self._pending is None:
            return None
        self._driver.require_connected()
        pending = self._pending
        with self.reserved(changes=False):
            result = await resolve(self, pending)
        self._conclude(pending, result)
        return result
