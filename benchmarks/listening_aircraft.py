"""An aircraft in a process of its own that notes when its ground station's frames come.

``python -m benchmarks.listening_aircraft PORT``: an armed ArduPlane in mode AUTO as far as one hears, behind
``udpin:127.0.0.1:PORT`` of a service. It takes every mode it is ordered into and shows it at once. Each line
of standard output is JSON: what came (``heartbeat``, ``order``) and when, by the monotonic clock that all
processes of a machine share. It ends with its standard input. pymavlink alone reads and writes its frames.
"""

from __future__ import annotations

import json
import select
import socket
import sys
import time

from pymavlink.dialects.v20 import ardupilotmega as mav

from app.priority import go_first

#: Custom modes of ArduPlane.
AUTO, RTL, LOITER = 10, 11, 12
_ORDERS = {mav.MAV_CMD_DO_SET_MODE, mav.MAV_CMD_NAV_RETURN_TO_LAUNCH}
_STATE_S = 0.25


class Aircraft:
    """What it says and hears."""

    def __init__(self, port: int) -> None:
        self._station = ("127.0.0.1", port)
        self.air = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.air.bind(("127.0.0.1", 0))
        self.air.setblocking(False)
        self._link = mav.MAVLink(None, srcSystem=7, srcComponent=1)
        self._link.robust_parsing = True
        self._begun_s = time.monotonic()
        self._mode = AUTO

    def _send(self, message: mav.MAVLink_message) -> None:
        self.air.sendto(message.pack(self._link), self._station)

    def heartbeat(self) -> None:
        """One, with the mode of now."""
        armed = mav.MAV_MODE_FLAG_SAFETY_ARMED | mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        self._send(
            self._link.heartbeat_encode(
                mav.MAV_TYPE_FIXED_WING,
                mav.MAV_AUTOPILOT_ARDUPILOTMEGA,
                armed,
                self._mode,
                mav.MAV_STATE_ACTIVE,
            )
        )

    def place(self) -> None:
        """Where it is: on its way."""
        self._send(self._link.extended_sys_state_encode(0, mav.MAV_LANDED_STATE_IN_AIR))
        since_s = time.monotonic() - self._begun_s
        lon_e7 = round((-117.7 + 1e-4 * since_s) * 1e7)
        self._send(
            self._link.global_position_int_encode(
                round(since_s * 1000), 335_000_000, lon_e7, 300_000, 250_000, 0, 2000, 0, 9000
            )
        )

    def hear(self) -> None:
        """Take in all that has come, and answer orders."""
        while True:
            try:
                data = self.air.recv(4096)
            except BlockingIOError:
                return
            for message in self._link.parse_buffer(data) or ():
                self._take(message)

    def _take(self, message: mav.MAVLink_message) -> None:
        kind = message.get_type()
        if kind == "HEARTBEAT":
            _tell("heartbeat")
        if kind != "COMMAND_LONG":
            return
        if message.command in _ORDERS:
            _tell("order")
            returns = message.command == mav.MAV_CMD_NAV_RETURN_TO_LAUNCH
            self._mode = RTL if returns else int(message.param2)
        self._send(self._link.command_ack_encode(message.command, mav.MAV_RESULT_ACCEPTED, 0, 0, 255, 190))
        if message.command in _ORDERS:
            self.heartbeat()


def _tell(what: str) -> None:
    sys.stdout.write(json.dumps({"what": what, "at_s": time.monotonic()}) + "\n")
    sys.stdout.flush()


def main() -> None:
    """Fly until standard input ends."""
    go_first()
    aircraft = Aircraft(int(sys.argv[1]))
    heartbeat_s = place_s = 0.0
    while True:
        now_s = time.monotonic()
        if now_s - heartbeat_s >= 1.0:
            heartbeat_s = now_s
            aircraft.heartbeat()
        if now_s - place_s >= _STATE_S:
            place_s = now_s
            aircraft.place()
        ready, _, _ = select.select([aircraft.air, sys.stdin], [], [], 0.05)
        if sys.stdin in ready and not sys.stdin.buffer.read1():
            return
        aircraft.hear()


if __name__ == "__main__":
    main()
