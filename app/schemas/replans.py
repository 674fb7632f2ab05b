"""The body that asks for a new plan of what is left while aircraft fly."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from app.schemas.base import Strict
from app.services.plans.replanned import Changes
from app.services.plans.replanning import Asked, Told
from planner.geojson.equipment import HIGHEST_ALOFT_M
from planner.geojson.going_on import MOST_S
from planner.wishes import GoingOn

Degrees = Annotated[float, Field(ge=-180, le=180)]


class WhereIn(Strict):
    """Where an aircraft is, and what it has left; what is left out comes from its recorded flight."""

    lon_deg: Degrees | None = None
    lat_deg: Annotated[float, Field(ge=-90, le=90)] | None = None
    height_m: Annotated[float, Field(gt=0, le=HIGHEST_ALOFT_M)] | None = Field(
        default=None, description="Over home."
    )
    heading_deg: Annotated[float, Field(ge=0, le=360)] | None = Field(
        default=None, description="Its course, clockwise from true north; needed of what flies on wings."
    )
    energy_left_wh: Annotated[float, Field(gt=0, le=1e7)] | None = Field(
        default=None, description="In its battery; the reserve is kept as before."
    )
    flown_m: Annotated[float, Field(ge=0, le=1e8)] | None = Field(
        default=None, description="Of its range used already [as recorded]."
    )
    flown_s: Annotated[float, Field(ge=0, le=1e7)] | None = Field(
        default=None, description="Of its flight time used already [as recorded]."
    )

    def told(self) -> Told:
        """The value."""
        return Told(**self.model_dump())


class ReplanIn(Strict):
    """What is other than it was planned; an empty body replans from where the recorded flights are."""

    vehicles: Annotated[dict[str, WhereIn], Field(max_length=100)] = Field(
        default={}, description="Where the plan's aircraft are, by name; those not named nor recorded stand."
    )
    at_s: Annotated[float, Field(ge=0, le=1e7)] | None = Field(
        default=None,
        description="Seconds of the plan's own clock: aircraft that are neither told of nor recorded are "
        "where the plan has them then, and what it sees until then is seen. Windows count from then on.",
    )
    seen: Annotated[list[dict[str, Any]], Field(max_length=1000)] | None = Field(
        default=None, description="GeoJSON areas that have been seen [what recorded flights saw]."
    )
    add: Annotated[list[dict[str, Any]], Field(max_length=2000)] = Field(
        default=[],
        description="GeoJSON features with their roles; one with the id of another takes its place.",
    )
    remove: Annotated[list[str], Field(max_length=2000)] = Field(
        default=[], description="Ids of features that are no longer."
    )
    lost: Annotated[list[str], Field(max_length=100)] = Field(
        default=[], description="Names of aircraft that fly no more."
    )
    wind: dict[str, Any] | None = Field(default=None, description="As in a scenario.")
    begins_in_s: Annotated[float, Field(ge=0, le=MOST_S)] | None = Field(
        default=None,
        description="From now until aircraft in flight fly the new plan: planning, upload, order to begin. "
        "It begins where their missions have them by then; passes that are over by then count as flown [2 s, "
        "and 0.1 s for each item that their missions have about]. Scenario and metrics of the answer tell it "
        "in `replan`.",
    )
    unless_better: Annotated[float, Field(ge=0, le=1)] = Field(
        default=GoingOn().unless_better,
        description="Who sees what, in which order, stays, unless another order is better by this part; "
        "metrics.replan tells what was kept, what moved, and what is new.",
    )

    def asked(self) -> Asked:
        """The value."""
        members = {} if self.wind is None else {"wind": self.wind}
        return Asked(
            self.at_s,
            {name: where.told() for name, where in self.vehicles.items()},
            self.seen,
            Changes(self.add, self.remove, self.lost, members),
            self.begins_in_s,
            self.unless_better,
        )
