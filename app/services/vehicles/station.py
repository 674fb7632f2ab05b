"""All that talks to vehicles, wired."""

from __future__ import annotations

from app.services.plans.library import PlanLibrary
from app.services.store.audit import AuditStore
from app.services.store.database import Database
from app.services.store.flights import FlightStore
from app.services.store.uploads import UploadStore
from app.services.store.vehicles import VehicleStore
from app.services.vehicles.audit import Audit
from app.services.vehicles.checks import Checks
from app.services.vehicles.fleet import Fleet
from app.services.vehicles.keys import KeyRing
from app.services.vehicles.recordings import Recordings
from app.services.vehicles.times import LinkTimes
from app.services.vehicles.transfers import Transfers
from mavlink.station.terrain import Heights


class Station:
    """The vehicles, what is put into them, and what is asked of them.

    Parameters
    ----------
    plans
        What may be put into them.
    track_interval_s
        Vehicle time between two recorded points of a track.
    recordings
        Where their links are recorded; None for nowhere.
    heights
        Where the ground's heights come from, for vehicles that ask.
    keys
        Where the vehicles' signing keys are found; None: none is signed with.
    """

    def __init__(
        self,
        database: Database,
        plans: PlanLibrary,
        track_interval_s: float,
        recordings: Recordings | None,
        times: LinkTimes,
        heights: Heights | None = None,
        keys: KeyRing | None = None,
    ) -> None:
        kept = VehicleStore(database)
        audit = Audit(AuditStore(database))
        self.checks = Checks(plans)
        self.transfers = Transfers(plans, UploadStore(database), kept, audit)
        self.fleet = Fleet(
            plans,
            self.transfers,
            FlightStore(database),
            kept,
            audit,
            track_interval_s,
            recordings,
            times,
            heights,
            keys,
        )
