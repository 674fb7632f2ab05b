"""A frame camera that looks down, or tilted forward, and takes photos that overlap.

Lengths are those of level ground; over relief what is planned is kept on the highest ground, where photos
see least, and quality on the lowest, where they see it worst.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

from planner.plan import Trigger
from planner.route import Look
from planner.sensors.optics import Optics
from planner.sensors.photo_band import Pattern, pattern
from planner.sensors.quality import Giqe4, Spectrum

#: Photos, and lanes, that overlap by this much or more see every place twice.
TWICE = 0.5

#: Of a fine JPEG, about.
BYTES_A_PIXEL = 0.4


@dataclass(frozen=True, slots=True)
class CameraSensor:
    """A camera.

    Parameters
    ----------
    optics
        Lens and chip, as mounted.
    forward_overlap, side_overlap
        Parts of a photo that the next, and that of the next lane, see again; below 1.
    tilt_rad
        Of its axis, from straight down forwards.
    min_interval_s
        Shortest time between two photos; 0 where unknown.
    trigger
        Photos by distance, by time, or a video.
    quality
        What else than the ground sampled distance decides NIIRS; None where unknown.
    model
        Its name in the camera database.
    relief_m
        The ground's height above and below the mean.
    pointing_margin_rad, position_margin_m
        How far the aircraft may roll or pitch, and be off its line, for all of a region still to be seen.
    steady_overlap
        Whether the overlaps, too, are kept with these margins used up; otherwise on the planned line.
    edge_overlap
        Whether the side overlap is kept up to a region's edges; else these are in view of one lane at least,
        no farther from it than from lane to lane.
    stabilised
        Whether the camera is kept in line with the course; otherwise it turns with the aircraft's nose.
    drift, toward_rad
        Of the wind it is flown in: its speed by the airspeed, and where the air moves to.
    airspeed_m_s
        It is flown at; 0 where photos may follow each other as fast as they like.
    photo_mb
        What a photo takes of its store, megabytes; None where unknown.
    thin
        True airspeed by that one: more than 1 for wings in thin air.
    """

    name: str
    optics: Optics
    forward_overlap: float = 0.75
    side_overlap: float = 0.65
    tilt_rad: float = 0.0
    min_interval_s: float = 0.0
    trigger: Trigger = "distance"
    spectrum: Spectrum = "visible"
    quality: Giqe4 | None = None
    model: str | None = None
    relief_m: float = 0.0
    pointing_margin_rad: float = 0.0
    position_margin_m: float = 0.0
    steady_overlap: bool = False
    edge_overlap: bool = True
    stabilised: bool = False
    drift: float = 0.0
    toward_rad: float = 0.0
    airspeed_m_s: float = 0.0
    thin: float = 1.0
    photo_mb: float | None = None

    @property
    def kind(self) -> str:
        """``camera``."""
        return "camera"

    @property
    def looks(self) -> tuple[Look, ...]:
        """Down, also where it is tilted: to neither side."""
        return ("down",)

    @property
    def resolution_m(self) -> float | None:
        """None: it depends on the height; see ``worst_gsd_m``."""
        return None

    def in_wind(self, drift: float, toward_rad: float) -> Self:
        """The same camera on an aircraft in a steady wind."""
        return replace(self, drift=drift, toward_rad=toward_rad)

    def over_relief(self, relief_m: float) -> Self:
        """The same camera over ground this much above and below its mean height."""
        return replace(self, relief_m=relief_m)

    def whole(self) -> Self:
        """The same camera without margins."""
        return replace(self, pointing_margin_rad=0.0, position_margin_m=0.0)

    @property
    def crabs(self) -> bool:
        """Whether photos turn with the nose."""
        return self.drift != 0.0 and not self.stabilised

    def crab_rad(self, angle_rad: float) -> float:
        """How far a photo is turned to the left of the course: asin(W sin δ / V), see ``vehicle.wind``."""
        if not self.crabs:
            return 0.0
        return math.asin(max(-1.0, min(1.0, self.drift * math.sin(angle_rad - self.toward_rad))))

    def pattern(self, angle_rad: float) -> Pattern:
        """Photos along a lane from one metre up, and the strip in which they overlap, margins left out."""
        # Courses told to a hundredth of a microradian: what rounding turns is the same course.
        return pattern(self.optics, self.tilt_rad, round(self.crab_rad(angle_rad), 8), self.forward_overlap)

    def swath_m(self, height_m: float) -> float:
        """Width of the strip that a lane sees on its course through still air, margins left out."""
        still = pattern(self.optics, self.tilt_rad, 0.0, self.forward_overlap)
        return 2.0 * still.half_width * max(height_m - self.relief_m, 0.0)

    def margin_m(self, height_m: float) -> float:
        """How far what a photo sees may be off beside the track, by place and roll together."""
        return self.position_margin_m + (height_m + self.relief_m) * math.tan(self.pointing_margin_rad)

    def half_width_m(self, height_m: float, angle_rad: float) -> float:
        """How far to either side of a lane all is seen, whatever of the margins is used up."""
        return self.pattern(angle_rad).half_width * (height_m - self.relief_m) - self.margin_m(height_m)

    def lane_spacing_m(self, height_m: float, angle_rad: float) -> float:
        """The widest distance between lanes that keeps the side overlap, and leaves nothing unseen."""
        strip_m = 2.0 * self.pattern(angle_rad).half_width * (height_m - self.relief_m)
        lost_m = 2.0 * self.margin_m(height_m)
        overlapping_m = (1.0 - self.side_overlap) * strip_m - (lost_m if self.steady_overlap else 0.0)
        return min(overlapping_m, strip_m - lost_m)

    def photo_spacing_m(self, height_m: float, angle_rad: float) -> float:
        """The widest distance between photos of a lane that keeps the forward overlap."""
        spacing_m = self.pattern(angle_rad).spacing * (height_m - self.relief_m)
        lost_m = 2.0 * (height_m + self.relief_m) * math.tan(self.pointing_margin_rad)
        return spacing_m - lost_m if self.steady_overlap else spacing_m

    @property
    def stored_mb(self) -> float:
        """What a photo takes of its store, megabytes: as given, else about that of a fine JPEG."""
        if self.photo_mb is not None:
            return self.photo_mb
        return self.optics.columns * self.optics.rows * BYTES_A_PIXEL / 1e6

    def least_spacing_m(self, angle_rad: float) -> float:
        """How far it is flown over the ground, at least, from one photo to the next that it can take."""
        if self.trigger == "video":
            return 0.0
        off_rad = angle_rad - self.toward_rad
        across = self.drift * math.sin(off_rad)
        over_ground = self.drift * math.cos(off_rad) + math.sqrt(max(self.thin**2 - across**2, 0.0))
        return self.min_interval_s * self.airspeed_m_s * over_ground

    def run_in_m(self, height_m: float, angle_rad: float) -> float:
        """How far before the ground on a lane's line the first photo is taken; negative: behind its start.

        Where photos overlap by half or more the beginning is in the next photo, too, and the first one's
        middle no farther from it than an interval; elsewhere no farther than that of the nearer of two photos
        from a place between them.
        """
        laid, high_m, low_m = self._drops(height_m, angle_rad)
        middle_m = max(laid.middle * high_m, laid.middle * low_m)
        return self._run_m(self.seen_in_m(height_m, angle_rad), middle_m, height_m, angle_rad)

    def run_out_m(self, height_m: float, angle_rad: float) -> float:
        """How far beyond the ground on a lane's line the last photo is taken; negative: before its end."""
        laid, high_m, low_m = self._drops(height_m, angle_rad)
        middle_m = max(-laid.middle * high_m, -laid.middle * low_m)
        return self._run_m(self.seen_out_m(height_m, angle_rad), middle_m, height_m, angle_rad)

    def kept_in_m(self, height_m: float, angle_rad: float) -> float:
        """How far before ground anywhere in a lane's strip the first photo is taken, for the overlap there.

        Where photos overlap by half or more the beginning is in two of them, elsewhere no farther from the
        middle of what the first one sees of its parallel than places between two photos are.
        """
        laid, high_m, low_m = self._drops(height_m, angle_rad)
        middle_m = max(laid.middle_last * high_m, laid.middle_last * low_m)
        return self._kept_m(self.seen_in_m(height_m, angle_rad), middle_m, height_m, angle_rad)

    def kept_out_m(self, height_m: float, angle_rad: float) -> float:
        """How far beyond ground anywhere in a lane's strip the last photo is taken, for the overlap there."""
        laid, high_m, low_m = self._drops(height_m, angle_rad)
        middle_m = max(-laid.middle_first * high_m, -laid.middle_first * low_m)
        return self._kept_m(self.seen_out_m(height_m, angle_rad), middle_m, height_m, angle_rad)

    def _kept_m(self, seen_m: float, middle_m: float, height_m: float, angle_rad: float) -> float:
        spacing_m = self.photo_spacing_m(height_m, angle_rad)
        if self.forward_overlap >= TWICE:
            return seen_m + spacing_m
        return max(seen_m, middle_m - spacing_m / 2.0)

    def seen_in_m(self, height_m: float, angle_rad: float) -> float:
        """How far before ground anywhere in a lane's strip a photo may be taken at the latest to see it."""
        laid, high_m, low_m = self._drops(height_m, angle_rad)
        return max(laid.before * high_m, laid.before * low_m) + self.margin_m(height_m)

    def seen_out_m(self, height_m: float, angle_rad: float) -> float:
        """How far beyond ground anywhere in a lane's strip a photo may be taken at the earliest to see it."""
        laid, high_m, low_m = self._drops(height_m, angle_rad)
        return self.margin_m(height_m) - min(laid.beyond * high_m, laid.beyond * low_m)

    def _run_m(self, seen_m: float, middle_m: float, height_m: float, angle_rad: float) -> float:
        spacing_m = self.photo_spacing_m(height_m, angle_rad)
        inside_m = middle_m - spacing_m / 2.0
        if self.forward_overlap >= TWICE:
            inside_m = min(middle_m, max(middle_m - spacing_m, seen_m + spacing_m))
        return max(seen_m, inside_m)

    def _drops(self, height_m: float, angle_rad: float) -> tuple[Pattern, float, float]:
        return self.pattern(angle_rad), height_m - self.relief_m, height_m + self.relief_m

    @property
    def worst_gsd(self) -> float:
        """Ground sampled distance of the worst pixel from one metre up: where the image looks farthest.

        The mean of along and across the line of sight there. Straight down all pixels are alike.
        """
        return self._gsd(math.tan(self.optics.half_height_rad))

    @property
    def mean_gsd(self) -> float:
        """The same in the middle of the image."""
        return self._gsd(0.0)

    def _gsd(self, up: float) -> float:
        # Of the image point v up: D = cos τ − v sin τ, across 1 / D and along 1 / D² of what it is below.
        down = math.cos(self.tilt_rad) - up * math.sin(self.tilt_rad)
        return self.optics.gsd_m(1.0) * (1.0 / down + 1.0 / (down * down)) / 2.0

    def worst_gsd_m(self, height_m: float) -> float:
        """Ground sampled distance of the worst pixel, on the lowest ground."""
        return self.worst_gsd * (height_m + self.relief_m)

    def height_for_m(self, gsd_m: float) -> float:
        """The greatest height over the mean ground from which no pixel covers more."""
        return gsd_m / self.worst_gsd - self.relief_m

    def worst_niirs(self, height_m: float) -> float | None:
        """NIIRS of the worst pixel, on the lowest ground; None where what decides it is unknown."""
        return None if self.quality is None else self.quality.niirs(self.worst_gsd_m(height_m))
