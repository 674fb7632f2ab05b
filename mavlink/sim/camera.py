"""The camera of the simulated aircraft as a MAVLink component: asked what it is, told to take pictures.

It carries out what the payload of the autopilot does; photos taken either way are counted once.

Source: MAVLink camera protocol v2.
"""

from __future__ import annotations

from collections.abc import Callable

from mavlink.sim.component import Component
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.payload import Payload
from mavlink.wire.items import Command
from mavlink.wire.messages import Message

COMPONENT = 100
#: MAV_TYPE.
_CAMERA = 30
#: A 24 megapixel frame: the sensor in millimetres, a lens of 16 mm.
_FOCAL_MM, _WIDTH_MM, _HEIGHT_MM, _COLUMNS, _ROWS = 16.0, 23.5, 15.6, 6000, 4000
#: CAMERA_CAP_FLAGS: video, images, modes, images in video mode, zoom, focus.
_CAN = 1 | 2 | 4 | 8 | 64 | 128
_PHOTO_MIB, _CAPACITY_MIB = 12.0, 64_000.0
#: The commands that asked for a message before REQUEST_MESSAGE did, and the messages' numbers.
_ASKED = {521: 259, 522: 260, 525: 261, 527: 262}


class Camera(Component):
    """Answers for a camera; the payload takes the photos."""

    def __init__(self, system_id: int, payload: Payload) -> None:
        super().__init__(system_id, COMPONENT, _CAMERA)
        self._payload = payload
        self._mode = 0
        self._zoom = self._focus = 0.0
        self._messages: dict[int, Callable[[AircraftState], Message]] = {
            259: self._information,
            260: self._settings,
            261: self._storage,
            262: self._capture_status,
        }

    def handle(
        self, command: int, params: tuple[float, float, float, float], state: AircraftState
    ) -> list[Message] | None:
        """What it says to a command, photos included; None for one that it does not know."""
        number = int(params[0]) if command == Command.REQUEST_MESSAGE else _ASKED.get(command)
        if number is not None:
            build = self._messages.get(number)
            return None if build is None else [build(state)]
        match command:
            case Command.SET_CAMERA_MODE:
                self._mode = int(params[1])
            case Command.SET_CAMERA_ZOOM:
                self._zoom = params[1]
            case Command.SET_CAMERA_FOCUS:
                self._focus = params[1]
            case _:
                return self._payload.handle(command, params, state)
        return []

    def _information(self, state: AircraftState) -> Message:
        return self.own(
            "CAMERA_INFORMATION",
            {
                "time_boot_ms": _ms(state),
                "vendor_name": tuple(b"Swathplan"),
                "model_name": tuple(b"simulated camera"),
                "focal_length": _FOCAL_MM,
                "sensor_size_h": _WIDTH_MM,
                "sensor_size_v": _HEIGHT_MM,
                "resolution_h": _COLUMNS,
                "resolution_v": _ROWS,
                "flags": _CAN,
            },
        )

    def _settings(self, state: AircraftState) -> Message:
        fields = {"mode_id": self._mode, "zoomLevel": self._zoom, "focusLevel": self._focus}
        return self.own("CAMERA_SETTINGS", {"time_boot_ms": _ms(state), **fields})

    def _storage(self, state: AircraftState) -> Message:
        used_mib = self._payload.photos * _PHOTO_MIB
        return self.own(
            "STORAGE_INFORMATION",
            {
                "time_boot_ms": _ms(state),
                "storage_id": 1,
                "storage_count": 1,
                "status": 2,
                "total_capacity": _CAPACITY_MIB,
                "used_capacity": used_mib,
                "available_capacity": max(_CAPACITY_MIB - used_mib, 0.0),
            },
        )

    def _capture_status(self, state: AircraftState) -> Message:
        (status,) = self._payload.reports("CAMERA_CAPTURE_STATUS", state)
        return self.own(status.name, status.fields)


def _ms(state: AircraftState) -> int:
    return round(state.time_s * 1000.0)
