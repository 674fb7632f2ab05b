"""What a sensor is to the stages: its name and kind, how well it sees, and what it sees from a level pass."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol, Self

from shapely.geometry import MultiPolygon, Polygon

from planner.route import Look


class Sensor(Protocol):
    """A sensor looked through on straight level passes; one file a kind beside this one.

    How its passes are laid, and what run-in they need, the family of its kind in ``planner.coverage`` knows.
    """

    @property
    def name(self) -> str:
        """As the client wrote it."""

    @property
    def kind(self) -> str:
        """What families and footprints are registered by."""

    @property
    def looks(self) -> tuple[Look, ...]:
        """The sides it can look to."""

    @property
    def resolution_m(self) -> float | None:
        """Ground resolution it delivers; None where unknown."""

    def in_wind(self, drift: float, toward_rad: float) -> Self:
        """The same on an aircraft in a steady wind: its speed by the airspeed, where the air moves to."""

    def over_relief(self, relief_m: float) -> Self:
        """The same over ground this much above and below its mean height."""

    def whole(self) -> Self:
        """The same without margins: what it really sees."""

    def swath_m(self, height_m: float) -> float:
        """Width of ground one pass sees from a height, margins left out."""


@dataclass(frozen=True, slots=True)
class SeenGround:
    """What one pass sees of the ground, in the local frame.

    Parameters
    ----------
    area
        Seen at full resolution.
    shadow_m2, layover_m2
        Ground in the beam all the while, but hidden, on a map.
    """

    area: Polygon | MultiPolygon
    shadow_m2: float = 0.0
    layover_m2: float = 0.0


class Properties(Protocol):
    """The properties of one sensor as the client wrote them, read by name; findings are kept, not raised.

    ``planner.geojson.fields.Fields`` is what is meant, and says more of each.
    """

    @property
    def owner(self) -> str:
        """How findings name the sensor."""

    def __contains__(self, name: str) -> bool: ...

    def raw(self, name: str, default: Any = None) -> Any:
        """The value as it stands; the default where absent."""

    def number(
        self,
        name: str,
        default: Any = ...,
        *,
        minimum: float = ...,
        maximum: float = ...,
        above: float = ...,
        below: float = ...,
    ) -> float | None:
        """A finite number within bounds; None where absent or wrong."""

    def integer(self, name: str, default: int, *, minimum: int) -> int:
        """A whole number."""

    def flag(self, name: str, default: bool) -> bool:
        """True or false."""

    def text(self, name: str, default: Any = ...) -> str | None:
        """A non-empty string; None where absent or wrong."""

    def choice(self, name: str, choices: Iterable[str], default: Any = ...) -> str | None:
        """One of several words; None where absent or wrong."""

    def wrong(self, name: str, message: str, fix: str, rule: str = ...) -> None:
        """Add a finding about one property."""

    def unused(self, name: str, why: str) -> None:
        """Add a warning where a property is given that nothing will read."""
