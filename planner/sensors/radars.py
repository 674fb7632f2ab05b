"""Radars by published figures: what a scenario's entry of ``sensors`` may begin with."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Radar:
    """Properties of one SAR.

    Parameters
    ----------
    incidence_deg
        Of the beam's centre; where its mount steers it, one that it is often used at.
    source
        Where the figures are published.
    """

    name: str
    incidence_deg: float
    elevation_beamwidth_deg: float
    azimuth_beamwidth_deg: float
    resolution_m: float | None
    wavelength_m: float | None
    look: str
    mode: str
    source: str

    @property
    def properties(self) -> dict[str, object]:
        """As a scenario writes them; the wavelength where the mode asks for it."""
        found: dict[str, object] = {
            "name": self.name,
            "type": "sar",
            "incidence_deg": self.incidence_deg,
            "elevation_beamwidth_deg": self.elevation_beamwidth_deg,
            "azimuth_beamwidth_deg": self.azimuth_beamwidth_deg,
            "look": self.look,
            "mode": self.mode,
        }
        if self.resolution_m is not None:
            found["resolution_m"] = self.resolution_m
        if self.mode == "spotlight":
            found["wavelength_m"] = self.wavelength_m
        return found


_LYNX = "Tsunoda et al., Lynx: a high-resolution synthetic aperture radar, SPIE 3704 (1999)"

RADARS: dict[str, Radar] = {
    radar.name: radar
    for radar in (
        Radar("lightweight UAV SAR", 45.0, 30.0, 10.0, None, None, "right", "stripmap",
              "Li, Chen, Wang, Li (2018), section 5: the one its cases are flown with"),
        Radar("GA-ASI Lynx strip", 60.0, 7.0, 3.2, 0.3, 0.018, "both", "stripmap", _LYNX),
        Radar("GA-ASI Lynx spot", 60.0, 7.0, 3.2, 0.1, 0.018, "both", "spotlight", _LYNX),
        Radar("NASA UAVSAR", 45.0, 40.0, 8.5, 2.0, 0.238, "left", "stripmap",
              "NASA JPL: UAVSAR instrument: looks from 25° to 65°, antenna 1.6 m along the track, 80 MHz"),
    )
}  # fmt: skip
