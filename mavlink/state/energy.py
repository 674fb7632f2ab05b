"""Energy that a flight drew, as its batteries tell.

Source: MAVLink ``common.xml``: BATTERY_STATUS (147: ``energy_consumed`` in hectojoules, ``current_consumed``
in milliampere hours, ``current_battery`` in centiamperes; −1 where not measured) and SYS_STATUS (1).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from mavlink.wire.messages import Message

_WH_PER_HECTOJOULE: Final = 100.0 / 3600.0
_NO_CELL_MV: Final = 65535
#: Between two readings further apart nothing is known of the current.
LONGEST_STEP_S: Final = 10.0

EnergySource = Literal["counted", "charge", "integrated"]
_RANKS: Final[dict[EnergySource, int]] = {"counted": 0, "charge": 1, "integrated": 2}


@dataclass(frozen=True, slots=True)
class Energy:
    """What was drawn.

    Parameters
    ----------
    source
        ``counted``: the battery's own count of energy; ``charge``: its count of charge times its voltage;
        ``integrated``: current times voltage over the time. The least exact of several batteries'.
    complete
        False where readings were missing meanwhile, or a battery began to count anew.
    """

    used_wh: float
    source: EnergySource
    complete: bool


@dataclass(slots=True)
class _Battery:
    used_wh: float = 0.0
    source: EnergySource = "integrated"
    complete: bool = True
    counted_hj: int | None = None
    charge_mah: int | None = None
    power_w: float | None = None
    at_s: float | None = None
    readings: int = 0


class EnergyMeter:
    """Adds up what batteries tell; several batteries are drawn from at once."""

    def __init__(self) -> None:
        self._batteries: dict[int, _Battery] = {}
        self._whole: _Battery = _Battery()

    def forget(self) -> None:
        """Begin anew."""
        self._batteries.clear()
        self._whole = _Battery()

    def take(self, message: Message, time_s: float | None) -> None:
        """One message, at a time of the vehicle's clock."""
        if time_s is None:
            return
        if message.name == "BATTERY_STATUS":
            battery = self._batteries.setdefault(message.integer("id"), _Battery())
            volts = _volts(message)
            _read(
                battery,
                time_s,
                message.integer("energy_consumed"),
                message.integer("current_consumed"),
                message.integer("current_battery"),
                volts,
            )
        elif message.name == "SYS_STATUS":
            millivolts = message.integer("voltage_battery")
            volts = None if millivolts in (0, 65535) else millivolts / 1000.0
            _read(self._whole, time_s, -1, -1, message.integer("current_battery"), volts)

    @property
    def energy(self) -> Energy | None:
        """What was drawn since the beginning; None where no battery tells."""
        told = [battery for battery in self._batteries.values() if battery.readings > 1]
        if not told and self._whole.readings > 1:
            told = [self._whole]
        if not told:
            return None
        worst = max((battery.source for battery in told), key=_RANKS.__getitem__)
        return Energy(sum(b.used_wh for b in told), worst, all(b.complete for b in told))


def _volts(message: Message) -> float | None:
    cells = message.fields.get("voltages")
    known = [mv for mv in cells if mv != _NO_CELL_MV] if isinstance(cells, tuple) else []
    return sum(float(mv) for mv in known) / 1000.0 if known else None


def _read(
    battery: _Battery, time_s: float, counted_hj: int, charge_mah: int, centiamperes: int, volts: float | None
) -> None:
    before_s = battery.at_s
    if counted_hj >= 0:
        if battery.counted_hj is not None:
            # A battery that counts anew was changed, or its monitor started again.
            battery.complete &= counted_hj >= battery.counted_hj
            battery.used_wh += max(counted_hj - battery.counted_hj, 0) * _WH_PER_HECTOJOULE
        battery.source = "counted"
    elif charge_mah >= 0 and volts is not None:
        if battery.charge_mah is not None:
            battery.complete &= charge_mah >= battery.charge_mah
            battery.used_wh += max(charge_mah - battery.charge_mah, 0) / 1000.0 * volts
        battery.source = "charge"
    elif centiamperes >= 0 and volts is not None:
        power_w = centiamperes / 100.0 * volts
        if before_s is not None and battery.power_w is not None:
            step_s = time_s - before_s
            if 0.0 <= step_s <= LONGEST_STEP_S:
                battery.used_wh += (power_w + battery.power_w) / 2.0 * step_s / 3600.0
            else:
                battery.complete = False
        battery.power_w, battery.source = power_w, "integrated"
    else:
        return
    battery.counted_hj = counted_hj if counted_hj >= 0 else None
    battery.charge_mah = charge_mah if charge_mah >= 0 else None
    battery.at_s = time_s
    battery.readings += 1
