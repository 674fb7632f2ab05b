"""A ground station without a socket, and missions to fly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from pyproj import Geod

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.geodesy import Place
from mavlink.wire.items import Command, Frame, MissionItem, MissionType
from mavlink.wire.messages import Message

GEOD = Geod(ellps="WGS84")
HOME = Place(47.3977, 8.5456, 488.0)
GROUND = (255, 190)


def from_ground(name: str, sender: tuple[int, int] = GROUND, **fields: int | float | str) -> Message:
    """A message as the link delivers it."""
    return Message(name, {"target_system": 1, "target_component": 1, **fields}, *sender)


def place_at(east_m: float, north_m: float, altitude_m: float = 588.0, origin: Place = HOME) -> Place:
    """The place at a distance from home, by geodesic."""
    azimuth_deg = math.degrees(math.atan2(east_m, north_m))
    lon, lat, _ = GEOD.fwd(origin.lon_deg, origin.lat_deg, azimuth_deg, math.hypot(east_m, north_m))
    return Place(lat, lon, altitude_m)


def east_north_m(lat_deg: float, lon_deg: float, origin: Place = HOME) -> tuple[float, float]:
    """East and north metres from home, by geodesic."""
    azimuth_deg, _, distance_m = GEOD.inv(origin.lon_deg, origin.lat_deg, lon_deg, lat_deg)
    azimuth_rad = math.radians(azimuth_deg)
    return distance_m * math.sin(azimuth_rad), distance_m * math.cos(azimuth_rad)


def item(
    command: int,
    place: Place | None = None,
    params: Sequence[float] = (),
    frame: int = Frame.GLOBAL_RELATIVE_ALT,
) -> MissionItem:
    """An item not numbered yet; its altitude counts from home."""
    p1, p2, p3, p4 = (*params, *(0.0,) * (4 - len(params)))
    if place is None:
        return MissionItem(0, Frame.MISSION, command, p1, p2, p3, p4)
    return MissionItem(
        0,
        frame,
        command,
        p1,
        p2,
        p3,
        p4,
        round(place.lat_deg * 1e7),
        round(place.lon_deg * 1e7),
        place.altitude_m - HOME.altitude_m,
    )


def waypoint(east_m: float, north_m: float, height_m: float = 100.0) -> MissionItem:
    return item(Command.NAV_WAYPOINT, place_at(east_m, north_m, HOME.altitude_m + height_m))


def numbered(items: Sequence[MissionItem], kind: MissionType = MissionType.MISSION) -> list[MissionItem]:
    return [replace(each, seq=seq, mission_type=kind) for seq, each in enumerate(items)]


def item_message(each: MissionItem, sender: tuple[int, int] = GROUND) -> Message:
    """The item as MISSION_ITEM_INT."""
    return from_ground(
        "MISSION_ITEM_INT",
        sender,
        seq=each.seq,
        frame=each.frame,
        command=each.command,
        current=0,
        autocontinue=1,
        param1=each.param1,
        param2=each.param2,
        param3=each.param3,
        param4=each.param4,
        x=each.x,
        y=each.y,
        z=each.z,
        mission_type=int(each.mission_type),
    )


def true_over_equivalent(above_sea_m: float) -> float:
    """By the standard atmosphere's temperature and the exponent g / (R L) - 1 of its density."""
    exponent = 9.80665 / (287.05287 * 0.0065) - 1.0
    return float((1.0 - 0.0065 * above_sea_m / 288.15) ** (-0.5 * exponent))


@dataclass
class Station:
    """Talks to an aircraft without a link; its clock moves only when told to."""

    aircraft: SimulatedAircraft
    now_s: float = 0.0
    heard: list[Message] = field(default_factory=list)
    track: list[AircraftState] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.wait(0.0)

    def say(self, message: Message) -> list[Message]:
        answers = self.aircraft.receive(message, self.now_s)
        self.heard += answers
        return answers

    def wait(self, seconds: float) -> list[Message]:
        self.now_s += seconds
        sent = self.aircraft.advance(self.now_s)
        self.heard += sent
        return sent

    def fly(self, seconds: float, step_s: float = 0.05) -> None:
        """Let time pass in small steps, keeping the track."""
        for _ in range(round(seconds / step_s)):
            self.wait(step_s)
            self.track.append(self.aircraft.state)

    def fly_until_disarmed(self, most_s: float) -> None:
        """Fly on until the aircraft has landed and disarmed."""
        end_s = self.now_s + most_s
        while self.aircraft.armed:
            assert self.now_s < end_s, f"still flying item {self.aircraft.pilot.current} after {most_s} s"
            self.fly(1.0)

    def upload(
        self,
        items: Sequence[MissionItem],
        kind: MissionType = MissionType.MISSION,
        patience_s: float = 12.0,
    ) -> int | None:
        """Serve the aircraft's requests; the type of the final MISSION_ACK, None without one in time."""
        rows = numbered(items, kind)
        end_s = self.now_s + patience_s
        inbox = self.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=int(kind)))
        result: int | None = None
        while self.now_s < end_s:
            for message in inbox:
                if message.name == "MISSION_ACK" and message.integer("type") != 13:
                    return message.integer("type")
                if message.name.startswith("MISSION_REQUEST"):
                    result = None
                    seq = message.integer("seq")
                    inbox = self.say(item_message(rows[seq]))
                    break
            else:
                inbox = self.wait(0.1)
        return result

    def download(self, kind: MissionType = MissionType.MISSION) -> list[MissionItem]:
        """The items the aircraft holds."""
        answers = self.say(from_ground("MISSION_REQUEST_LIST", mission_type=int(kind)))
        count = next(m for m in answers if m.name == "MISSION_COUNT").integer("count")
        items = []
        for seq in range(count):
            request = from_ground("MISSION_REQUEST_INT", seq=seq, mission_type=int(kind))
            answers = [m for m in self.say(request) if m.name == "MISSION_ITEM_INT"]
            if not answers:
                answers = [m for m in self.say(request) if m.name == "MISSION_ITEM_INT"]
            (message,) = answers
            items.append(
                MissionItem(
                    message.integer("seq"),
                    message.integer("frame"),
                    message.integer("command"),
                    message.number("param1"),
                    message.number("param2"),
                    message.number("param3"),
                    message.number("param4"),
                    message.integer("x"),
                    message.integer("y"),
                    message.number("z"),
                    mission_type=kind,
                )
            )
        self.say(from_ground("MISSION_ACK", type=0, mission_type=int(kind)))
        return items

    def command(self, command: int, *params: float) -> int | None:
        """Send COMMAND_LONG; the result of its COMMAND_ACK."""
        values = {f"param{n}": value for n, value in enumerate((*params, *(0.0,) * (7 - len(params))), 1)}
        answers = self.say(from_ground("COMMAND_LONG", command=command, confirmation=0, **values))
        acks = [m for m in answers if m.name == "COMMAND_ACK" and m.integer("command") == command]
        return acks[0].integer("result") if acks else None

    def start(self) -> None:
        """Arm and start the mission."""
        assert self.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
        assert self.command(Command.MISSION_START) == 0

    def texts(self) -> list[str]:
        return [message.text("text") for message in self.heard if message.name == "STATUSTEXT"]

    def named(self, name: str, component_id: int = 0) -> list[Message]:
        """Messages of a name: the autopilot's own, or those of another component."""
        return [each for each in self.heard if each.name == name and each.component_id == component_id]

    def reached(self) -> list[int]:
        return [message.integer("seq") for message in self.named("MISSION_ITEM_REACHED")]


def landing_mission(body: Sequence[MissionItem], *, home_row: bool) -> list[MissionItem]:
    """A take-off to the north, a body, an approach from the south and a landing at home."""
    ends = [
        *([item(Command.NAV_WAYPOINT, HOME)] if home_row else []),
        item(Command.NAV_TAKEOFF, place_at(0.0, 600.0, HOME.altitude_m + 50.0), (10.0,)),
    ]
    approach = item(Command.NAV_LOITER_TO_ALT, place_at(-300.0, -900.0, HOME.altitude_m + 40.0), (1.0, 100.0))
    final = item(Command.NAV_WAYPOINT, place_at(0.0, -600.0, HOME.altitude_m + 40.0))
    land = item(Command.NAV_LAND, replace(HOME))
    return [*ends, *body, approach, final, land]


def arc_waypoints(
    centre_east_m: float,
    centre_north_m: float,
    radius_m: float,
    start_deg: float,
    sweep_deg: float,
    step_deg: float,
    height_m: float = 100.0,
) -> list[MissionItem]:
    """Waypoints on an arc, angles counter-clockwise from east; both ends are among them."""
    count = max(1, round(abs(sweep_deg) / step_deg))
    points = []
    for number in range(count + 1):
        angle_rad = math.radians(start_deg + sweep_deg * number / count)
        points.append(
            waypoint(
                centre_east_m + radius_m * math.cos(angle_rad),
                centre_north_m + radius_m * math.sin(angle_rad),
                height_m,
            )
        )
    return points
