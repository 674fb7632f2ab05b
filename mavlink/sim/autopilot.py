"""The simulated aircraft: messages and time in, messages out; no socket, no clock."""

from __future__ import annotations

from mavlink.sim.camera import COMPONENT as CAMERA
from mavlink.sim.camera import Camera
from mavlink.sim.commands import CommandResult, carry_out, change_mode, order_of
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.executor import Do, Landed, Reached, Said, place_of
from mavlink.sim.faults import Fault, parse_faults
from mavlink.sim.geodesy import Place
from mavlink.sim.gimbal import COMPONENT as GIMBAL
from mavlink.sim.gimbal import Gimbal
from mavlink.sim.missions import MissionServer
from mavlink.sim.models import build_dynamics
from mavlink.sim.modes import Flavour, Mode, mode_of
from mavlink.sim.parameters import Parameters
from mavlink.sim.payload import Payload
from mavlink.sim.pilot import Pilot
from mavlink.sim.replies import received_item, sender, status_text
from mavlink.sim.settings import SimSettings
from mavlink.sim.small_talk import answer
from mavlink.sim.streams import OF_THE_GIMBAL, OF_THE_PAYLOAD, STREAMS, Streams
from mavlink.sim.telemetry import Snapshot, build
from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message

#: MISSION_ITEM with this in ``current`` is ArduPilot's "fly here now".
_GUIDED_ITEM = 2


class SimulatedAircraft:
    """A fixed wing or a multirotor with an autopilot.

    Two clocks: ``now_s`` of ``receive`` and ``advance`` is the link's, by which the mission protocol repeats
    and gives up; the simulated time runs ``settings.speedup`` times as fast while armed, and with it flight,
    timestamps and telemetry rates. It stands still until armed, and leaves the ground only for a take-off, of
    its mission or ordered.
    """

    def __init__(self, settings: SimSettings) -> None:
        self._settings = settings
        self._faults = parse_faults(settings.faults)
        self._dynamics = build_dynamics(settings)
        self.pilot = Pilot(settings)
        self.payload = Payload(settings, self._faults)
        self.gimbal = Gimbal(settings.system_id) if settings.gimbal else None
        self._camera = Camera(settings.system_id, self.payload) if settings.camera else None
        self.streams = Streams(settings.autopilot)
        self.missions = MissionServer(
            settings.autopilot,
            settings.home,
            faults=self._faults,
            max_items=settings.max_items,
            sensor_command=settings.sensor_command,
            hovers=settings.hovers,
            vanish_after_items=settings.vanish_after_items,
            vanish_for_s=settings.vanish_for_s,
        )
        self._parameters = Parameters(settings)
        self._revision = self.missions.revision
        self._heard_s: float | None = None
        self._owed_s = 0.0
        self._consumed_j = 0.0

    @property
    def settings(self) -> SimSettings:
        """What it started from."""
        return self._settings

    @property
    def state(self) -> AircraftState:
        """Where it is and how it flies."""
        return self._dynamics.state

    @property
    def armed(self) -> bool:
        """Whether it may move."""
        return self.pilot.armed

    @property
    def mode(self) -> Mode:
        """The flight mode."""
        return self.pilot.mode

    @property
    def sim_time_s(self) -> float:
        """Simulated time since boot."""
        return self.state.time_s

    @property
    def mission_complete(self) -> bool:
        """Whether the stored mission has been flown to its end."""
        return self.pilot.mission_complete

    @property
    def arming_denied(self) -> str:
        """Why it cannot be armed; empty when it can."""
        return "pre-arm checks failed" if Fault.DENY_ARM in self._faults else ""

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Answers to one message; none to those addressed to another system."""
        if self.missions.silent(now_s):
            return []
        if message.fields.get("target_component") in (CAMERA, GIMBAL):
            return self._to_payload(message)
        if not self._addressed(message):
            return []
        match message.name:
            case "COMMAND_LONG" | "COMMAND_INT":
                return self._command(message)
            case "SET_MODE":
                mode = mode_of(
                    self._settings.autopilot,
                    message.integer("custom_mode"),
                    hovers=self._settings.hovers,
                )
                return change_mode(self, mode)[1]
            case "MISSION_SET_CURRENT":
                # Past the end ArduPilot and PX4 say nothing.
                chosen = self.pilot.select(message.integer("seq"), self.state)
                return self._named("MISSION_CURRENT") if chosen else []
            case "MISSION_ITEM" | "MISSION_ITEM_INT" if message.integer("current") == _GUIDED_ITEM:
                return self._fly_here(message)
        if message.name.startswith("MISSION_") and self.state.time_s < self._settings.boot_s:
            return []
        answers = self.missions.receive(message, now_s) or self._set_or_told(message)
        self._reload()
        return answers or answer(message, self.state.time_s, self.streams)

    def _set_or_told(self, message: Message) -> list[Message]:
        """The parameter protocol; what is set is flown by."""
        answers = self._parameters.receive(message)
        if self._parameters.settings is not self._settings:
            self._settings = self._parameters.settings
            self.pilot.retune(self._settings)
        return answers

    def _to_payload(self, message: Message) -> list[Message]:
        """Orders to the camera or the gimbal instead of the autopilot."""
        camera, gimbal = self._camera, self.gimbal
        if message.name != "COMMAND_LONG" or message.integer("target_system") != self._settings.system_id:
            return []
        order, asker = order_of(message), sender(message)
        params = (order.param1, order.param2, order.param3, order.param4)
        if message.integer("target_component") == CAMERA and camera is not None:
            said = camera.handle(order.command, params, self.state)
            result = CommandResult.UNSUPPORTED if said is None else CommandResult.ACCEPTED
            return [*(said or []), camera.acknowledgement(order.command, asker, result)]
        if message.integer("target_component") == GIMBAL and gimbal is not None:
            told = gimbal.told(order.command, order.param1, self.state)
            result = CommandResult.UNSUPPORTED if told is None else CommandResult.ACCEPTED
            return [*([told] if told else []), gimbal.acknowledgement(order.command, asker, result)]
        return []

    def advance(self, now_s: float) -> list[Message]:
        """Fly up to a time of the link's clock; everything sent meanwhile, in order.

        The first call only sets the clock.
        """
        if self._heard_s is None:
            self._heard_s = now_s
        out = self.missions.advance(now_s)
        rate = self._settings.speedup if self.pilot.armed else 1.0
        self._owed_s += max(now_s - self._heard_s, 0.0) * rate
        self._heard_s = max(now_s, self._heard_s)
        step_s = self._dynamics.step_s
        while self._owed_s >= step_s:
            self._owed_s -= step_s
            out += self._step(step_s)
            if not self.pilot.armed and rate != 1.0:
                # Disarmed after a landing: simulated time goes back to its own pace.
                self._owed_s /= rate
                rate = 1.0
        self._reload()
        return [] if self.missions.silent(now_s) else out

    def message(self, name: str) -> Message | None:
        """A telemetry message as of now; None when there is none of that name."""
        if name in OF_THE_PAYLOAD:
            return next(iter(self.payload.reports(name, self.state)), None)
        if name in OF_THE_GIMBAL:
            return next(iter(self.gimbal.reports(name, self.state)), None) if self.gimbal else None
        return build(name, self._snapshot(), self._settings) if name in STREAMS else None

    def move_home(self, home: Place) -> None:
        """Set another home."""
        self.pilot.home = home
        self.missions.home = home

    def _step(self, step_s: float) -> list[Message]:
        pilot = self.pilot
        command = pilot.command(self.state)
        out = self._events()
        state = self._dynamics.step(step_s, command)
        self._consumed_j += state.power_w * step_s
        out += self.payload.step(state)
        out += self._camera.heartbeats(state) if self._camera is not None else []
        out += self.gimbal.step(state) if self.gimbal is not None else []
        flying = pilot.armed and pilot.mode is Mode.AUTO
        if self.missions.flying and not flying:
            out += self.payload.rest(state)
        self.missions.flying = flying
        due = self.streams.due(state.time_s)
        if due:
            snapshot = self._snapshot()
            for name in due:
                if name in OF_THE_PAYLOAD:
                    out += self.payload.reports(name, state)
                elif name in OF_THE_GIMBAL:
                    out += self.gimbal.reports(name, state) if self.gimbal is not None else []
                else:
                    out.append(build(name, snapshot, self._settings))
        return out

    def _events(self) -> list[Message]:
        """Messages for what the pilot did, and its orders to the payload carried out."""
        if not self.pilot.events:
            return []
        out: list[Message] = []
        events, self.pilot.events = self.pilot.events, []
        for event in events:
            match event:
                case Reached(seq):
                    out.append(Message("MISSION_ITEM_REACHED", {"seq": seq}))
                    out += self._named("MISSION_CURRENT")
                case Do(item):
                    out += self._do(item)
                case Said(severity, text):
                    out.append(status_text(severity, text))
                case Landed():
                    self.pilot.disarm()
                    out.append(status_text(6, "Landed, throttle disarmed"))
                    out += self._named("HEARTBEAT")
                    out += self._named("EXTENDED_SYS_STATE")
        return out

    def _do(self, item: MissionItem) -> list[Message]:
        itself = (self._settings.system_id, self._settings.component_id)
        if self.gimbal is not None and self.gimbal.handle(item, itself):
            return []
        params = (item.param1, item.param2, item.param3, item.param4)
        said = self.payload.handle(item.command, params, self.state)
        if said is None and self._camera is not None:
            said = self._camera.handle(item.command, params, self.state)
        return said or []

    def _command(self, message: Message) -> list[Message]:
        order = order_of(message)
        try:
            result, said = carry_out(self, order, sender(message))
        except (ValueError, OverflowError):
            # A NaN or an infinity where a whole number is meant.
            result = CommandResult.DENIED
            said = [status_text(4, f"Command {order.command}: bad parameter")]
        if Fault.NO_COMMAND_ACK in self._faults:
            return said
        fields = {
            "command": order.command,
            "result": int(result),
            "progress": 0,
            "result_param2": 0,
            "target_system": message.system_id,
            "target_component": message.component_id,
        }
        return [*said, Message("COMMAND_ACK", fields)]

    def _fly_here(self, message: Message) -> list[Message]:
        """ArduPilot's guided waypoint; PX4 knows no such thing."""
        flown = self._settings.autopilot is Flavour.ARDUPILOT and not self.state.on_ground
        if flown:
            place = place_of(received_item(message, MissionType.MISSION), self.pilot.home)
            self.pilot.set_mode(Mode.GUIDED, self.state, place)
        result = MissionResult.ACCEPTED if flown else MissionResult.ERROR
        fields = {
            "target_system": message.system_id,
            "target_component": message.component_id,
            "type": int(result),
            "mission_type": 0,
        }
        return [Message("MISSION_ACK", fields)]

    def _reload(self) -> None:
        """Hand a changed mission to the pilot once its upload is over."""
        if self.missions.revision != self._revision and not self.missions.receiving:
            self._revision = self.missions.revision
            self.pilot.load(self.missions.items(), self.state)

    def _addressed(self, message: Message) -> bool:
        system = message.fields.get("target_system", 0)
        component = message.fields.get("target_component", 0)
        return system in (0, self._settings.system_id) and component in (0, self._settings.component_id)

    def _named(self, name: str) -> list[Message]:
        message = self.message(name)
        return [message] if message is not None else []

    def _snapshot(self) -> Snapshot:
        pilot = self.pilot
        return Snapshot(
            state=self.state,
            home=pilot.home,
            mode=pilot.mode,
            armed=pilot.armed,
            consumed_j=self._consumed_j,
            current=pilot.current,
            total=len(self.missions.items()),
            mission_complete=pilot.mission_complete,
            paused=pilot.paused,
            fenced=bool(self.missions.items(MissionType.FENCE)),
            list_ids=tuple(self.missions.opaque_id(kind) for kind in MissionType),
        )
