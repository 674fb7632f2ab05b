"""What a vehicle needs of whoever remembers for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from app.services.records import HeldMission

if TYPE_CHECKING:
    from app.services.vehicles.vehicle import Vehicle


class Memory(Protocol):
    """Keeps over restarts what became of uploads and which system a vehicle is."""

    async def record(self, vehicle: Vehicle) -> None:
        """An upload whose outcome was unknown has been resolved by reading back."""

    async def still_holds(self, vehicle: Vehicle, held: HeldMission) -> bool | None:
        """Whether it holds the plan it held before, asked once it is heard; None: nobody can tell."""

    async def identified(self, vehicle: Vehicle) -> None:
        """Its system id has become known, or is another by somebody's word."""
