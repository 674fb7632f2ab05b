"""Bodies of requests and answers about vehicles."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime
from typing import Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field

from app.schemas.base import Strict
from app.schemas.flights import SensorActionOut
from app.schemas.forwards import ForwardIn, ForwardOut, ForwardsOut
from app.schemas.missions import SentOut, UploadOut
from app.services.vehicles.forwarding import MOST_FORWARDS
from app.services.vehicles.items import state_json
from app.services.vehicles.order_book import Order
from app.services.vehicles.orders import WAIT_S
from app.services.vehicles.vehicle import Vehicle

CommandName = Literal[
    "arm", "disarm", "start", "pause", "resume", "rtl", "goto_item", "land", "hold", "sensor_off"
]


class VehicleIn(Strict):
    """A vehicle to connect."""

    name: str = Field(
        min_length=1,
        max_length=100,
        pattern=r"^[^\x00-\x1f\x7f]*[^\s\x00-\x1f\x7f][^\x00-\x1f\x7f]*$",
        description="Something to see, and no control characters.",
        examples=["uav-1"],
    )
    url: str = Field(
        min_length=1,
        max_length=300,
        description="udpin:host:port, udpout:host:port, tcp:host:port, serial:device:baud, or sim: for a "
        "simulated aircraft, e.g. sim:?speedup=20&home=33.48,-117.75&autopilot=px4&airspeed=20"
        "&turn_radius=100&wind=8,270. sim: alone is a fixed wing, type=multirotor the other kind. Without a "
        "home it stands where the plan it gets begins. A recording "
        "(.tlog) is watched with replay:path?speedup=10&plan=<id of the plan flown>&payload=<as uploaded>.",
        examples=["sim:", "udpin:127.0.0.1:14550"],
    )
    timeout_s: float = Field(
        default=10.0, ge=0.1, le=60, description="How long to wait for its first heartbeat."
    )
    forward: list[ForwardIn] = Field(
        default=[], max_length=MOST_FORWARDS, description="Other ground stations that hear it too."
    )


class SensorOut(BaseModel):
    """The sensor, by its own report or by the output that switches it."""

    on: bool | None = Field(description="null: nothing shows it, or the vehicle is silent.")
    since_s: float | None = Field(description="For how long it has been so, seconds.", examples=[12.5])
    last_action: SensorActionOut | None = Field(
        description="When the service last switched it off by itself: left on outside the passes."
    )


class LinkOut(BaseModel):
    """How the vehicle is heard."""

    quality: float | None = Field(
        description="Share of its frames that came in the last ten seconds, 0 to 1; null: too few to tell.",
        examples=[0.98],
    )
    lost: bool = Field(description="It was heard, and is silent now.")
    lost_since: datetime | None = Field(description="When it was last heard, while the link is lost.")


class CommandIn(Strict):
    """An explicit flight command."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"command": "start", "arm_first": True},
                {"command": "goto_item", "seq": 12},
                {"command": "sensor_off", "payload": "relay:0"},
            ]
        }
    )

    command: CommandName = Field(
        description="arm: motors ready, nothing moves. start: take off and fly the mission. pause, resume: "
        "within it. hold: wait where it is. rtl: come back. land: come down where it is; a fixed wing by "
        "its mission's landing. goto_item: on with the mission from item `seq`. sensor_off: the payload, "
        "whatever the mode."
    )
    seq: int | None = Field(default=None, ge=0, le=65535, description="Item, for goto_item.")
    arm_first: bool = Field(
        default=False, description="With start: arm a disarmed aircraft, which then takes off."
    )
    hold_first: bool = Field(
        default=False, description="With arm: first into a mode that keeps the aircraft on the ground."
    )
    as_held: bool = Field(
        default=False,
        description="With start and arm: whatever mission is on board, though it is not the one last sent.",
    )
    payload: str | None = Field(
        default=None,
        max_length=200,
        description="With sensor_off: what to switch [that of the mission held].",
    )
    wait_s: float = Field(
        default=WAIT_S, ge=0.0, le=60.0, description="How long to wait for its end; then it is `pending`."
    )


class CommandOut(BaseModel):
    """A flight command as it stands; refused, overtaken and unknown ones are answered as problems first."""

    vehicle_id: str
    command_id: str
    command: CommandName
    outcome: Literal["done", "refused", "pending", "overtaken", "unknown"] = Field(
        description="done: the vehicle shows it. pending: not answered, or not shown yet. overtaken: a newer "
        "command came before. unknown: it may have been carried out."
    )
    reason: str = Field(description="In words; empty where nothing is to be said.")
    unrecorded: str | None = Field(
        description="Why the command is not in the audit yet, e.g. a full disk; null: it is."
    )
    given_at: datetime

    @classmethod
    def of(cls, vehicle: Vehicle, order: Order) -> Self:
        """The answer for an order."""
        return cls.model_validate(
            {
                "vehicle_id": vehicle.id,
                "command_id": order.id,
                "command": order.command,
                "outcome": order.outcome,
                "reason": order.reason,
                "unrecorded": order.unrecorded,
                "given_at": order.given_at,
            }
        )


class CommandList(BaseModel):
    """The latest flight commands of a vehicle, newest first."""

    commands: list[CommandOut]


class DoubtOut(BaseModel):
    """Why it is not certain that orders reach the vehicle meant, and it alone."""

    rule: str = Field(examples=["two-aircraft"])
    message: str
    fix: str = Field(description="What resolves it.")


class VehicleOut(BaseModel):
    """A vehicle and how it is."""

    id: str
    name: str
    url: str
    connected: bool
    system_id: int | None = Field(description="Its MAVLink system; null: not heard yet.")
    other_system: int | None = Field(
        description="Another autopilot that answers in its place while it is silent: a swapped aircraft. It "
        "is not talked to until it is acknowledged, or let go and connected as another vehicle."
    )
    address: str | None = Field(
        description="Where it is heard from, on a port where anybody may speak; it alone is believed."
    )
    strangers: list[str] = Field(
        description="Other addresses heard on that port lately: neither believed nor sent to."
    )
    namesakes: list[str] = Field(
        description="Other vehicles of the same system id, on links of their own: each gets its own orders, "
        "as long as no radio carries them to both."
    )
    doubt: DoubtOut | None = Field(
        description="Why orders that make it fly, and uploads, are refused; stops are sent all the same."
    )
    signing: str | None = Field(
        description="verified: its frames are signed with the key given. no_key: they are signed, and no "
        "key is given. unsigned, wrong_key, replayed: a key is given, and for this its frames do not count. "
        "null: it does not sign."
    )
    position_age_s: float | None = Field(
        description="How old the position in `state` is, seconds; null: it never told one.", examples=[0.2]
    )
    sensor: SensorOut
    link: LinkOut
    link_failure: str | None = Field(description="Why its link is not open; it is tried again and again.")
    simulated: bool
    replay: bool = Field(description="It is a recording: it takes no transfers and no commands.")
    created_at: datetime
    operation: str | None = Field(description="What is at work on it now.")
    transfer: dict[str, Any] | None = Field(description="Of an upload at work: part, done, total.")
    pending: bool = Field(description="An upload's outcome is unknown; it is read back on reconnection.")
    plan_id: str | None = Field(description="The plan it holds, read back and compared.")
    sent: SentOut | None = Field(description="The mission last sent from here; null: none, or cleared.")
    mission_lands: bool | None = Field(
        description="Whether the mission it holds has a landing, by which alone a fixed wing is landed by "
        "`land`; null: what it holds is not known without reading it."
    )
    flight_id: str | None = Field(description="The flight being recorded.")
    forward: list[ForwardOut] = Field(description="Other ground stations its link is forwarded to.")
    command: CommandOut | None = Field(description="The flight command given last from here.")
    upload: UploadOut | None = Field(description="The last upload, without its items.")
    state: dict[str, Any] = Field(description="Position, attitude, mode, mission, battery …; null: not said.")

    @classmethod
    def of(cls, vehicle: Vehicle) -> Self:
        """The answer for a vehicle."""
        state, last = vehicle.state, vehicle.safety.last
        return cls(
            id=vehicle.id,
            name=vehicle.name,
            url=vehicle.url,
            connected=vehicle.state.connected,
            system_id=vehicle.state.system_id or vehicle.system_id or None,
            other_system=vehicle.state.other_system,
            address=state.address,
            strangers=list(state.strangers),
            namesakes=list(vehicle.namesakes),
            signing=state.signing,
            doubt=None if state.doubt is None else DoubtOut(**asdict(state.doubt)),
            position_age_s=vehicle.age_s(state.position_heard_s),
            sensor=SensorOut(
                on=state.sensor_shown,
                since_s=vehicle.age_s(state.sensor_since_s),
                last_action=None if last is None else SensorActionOut(**asdict(last)),
            ),
            link=LinkOut(
                quality=vehicle.link_quality,
                lost=vehicle.lost_since is not None,
                lost_since=vehicle.lost_since,
            ),
            link_failure=vehicle.link_failure,
            simulated=vehicle.simulated is not None,
            replay=vehicle.replay,
            created_at=vehicle.created_at,
            operation=vehicle.turns.operation,
            transfer=vehicle.turns.progress,
            pending=vehicle.pending,
            plan_id=vehicle.held.plan_id if vehicle.held else None,
            sent=SentOut.of(vehicle),
            mission_lands=vehicle.mission_lands,
            flight_id=vehicle.flight_id,
            forward=ForwardsOut.of(vehicle).forward,
            command=None if vehicle.book.latest is None else CommandOut.of(vehicle, vehicle.book.latest),
            upload=UploadOut.of(vehicle.upload, items=False) if vehicle.upload else None,
            state=state_json(vehicle.state),
        )


class VehicleList(BaseModel):
    """Vehicles, oldest first."""

    vehicles: list[VehicleOut]


class LogOut(BaseModel):
    """One recording of a vehicle's link."""

    name: str
    size_bytes: int
    ended_at: datetime = Field(description="When it was last written to.")
    url: str = Field(description="Where to download it; play it with the vehicle address replay:<file>.")


class LogList(BaseModel):
    """Recordings of a vehicle's link, oldest first."""

    vehicle_id: str
    failure: str | None = Field(
        description="Why the link is not recorded now, e.g. a full disk; it is tried again and again."
    )
    logs: list[LogOut]


class IdentityIn(Strict):
    """The aircraft that is the vehicle from now on."""

    system_id: int = Field(ge=1, le=255, description="As other_system says.")


class SigningIn(Strict):
    """What is to become of signing. The key itself is read from the service's file or environment."""

    action: Literal["use", "set_up", "remove"] = Field(
        description="use: sign and verify with the key given, which the vehicle has already. set_up: hand it "
        "to the vehicle first. remove: have the vehicle sign no more."
    )


class AddressIn(Strict):
    """Where the vehicle is from now on."""

    address: str = Field(
        min_length=3,
        max_length=100,
        description="As `address` or `strangers` says.",
        examples=["10.0.0.7:14555"],
    )
