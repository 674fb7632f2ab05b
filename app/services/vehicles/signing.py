"""A vehicle's signing, changed by explicit order."""

from __future__ import annotations

from typing import Literal

import structlog

from app.services.errors import ConflictError
from app.services.vehicles.vehicle import Vehicle
from mavlink.errors import SigningError

log = structlog.get_logger(__name__)

Action = Literal["use", "set_up", "remove"]


async def change(vehicle: Vehicle, action: Action) -> None:
    """Use a vehicle's key, hand it over, or have the vehicle sign no more.

    Raises
    ------
    ConflictError
        No key of it is given, or the vehicle does not show that it has it; all is as before.
    RefusedError
        The key that is given is none, or others may read it.
    LinkError
        The vehicle is not there.
    """
    async with vehicle.turns.busy("changing its signing", changes=True):
        if vehicle.keys is None:
            raise ConflictError("this service has no place for signing keys")
        signing = None if action == "remove" else vehicle.keys.need(vehicle.name, vehicle.id)
        entry = await vehicle.audit.begin("signing", vehicle.id, vehicle.name, {"action": action})
        try:
            if signing is None:
                await vehicle.client.stop_signing()
            elif action == "use":
                await vehicle.client.use_key(signing)
            else:
                await vehicle.client.set_up_signing(signing)
        except BaseException as error:
            vehicle.audit.end(entry, "refused", str(error) or type(error).__name__)
            if isinstance(error, SigningError):
                raise ConflictError(f"{vehicle.name}: {error}") from error
            raise
        vehicle.audit.end(entry, "accepted")
        log.warning("signing changed", vehicle=vehicle.name, action=action)
        vehicle.tell()
