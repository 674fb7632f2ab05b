"""How much can be made out in an image: NIIRS by the general image quality equation, and its inverse.

Source: Stecz and Gromada 2020 (see ``optics``), equations 1 and 6 to 8 and Algorithm 1: GIQE 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

Spectrum = Literal["visible", "infrared"]

#: ST of equation 1.
SENSOR_TYPE: Final[dict[Spectrum, float]] = {"visible": 10.25, "infrared": 10.75}
_METRES_AN_INCH: Final = 0.0254
_SHARP_EDGE: Final = 0.9
_NOISE, _OVERSHOOT = 0.344, 0.656


@dataclass(frozen=True, slots=True)
class Giqe4:
    """What of an image's quality does not depend on where it is taken from.

    Parameters
    ----------
    spectrum
        ``visible`` or ``infrared``.
    rer
        Relative edge response, behind all processing.
    snr
        Signal to noise ratio of the unprocessed image.
    noise_gain
        G, by which sharpening makes noise stronger; 1 without.
    overshoot
        H, the height of overshoot that sharpening leaves.
    """

    spectrum: Spectrum
    rer: float
    snr: float
    noise_gain: float = 1.0
    overshoot: float = 0.0

    def __post_init__(self) -> None:
        if not (0.0 < self.rer < math.inf and 0.0 < self.snr < math.inf):
            raise ValueError("edge response and signal to noise ratio are positive numbers")
        if not (0.0 <= self.noise_gain < math.inf and math.isfinite(self.overshoot)):
            raise ValueError("the noise gain is not negative, and the overshoot a number")

    @property
    def slope(self) -> float:
        """A: NIIRS a decade of ground sampled distance."""
        return -3.32 if self.rer >= _SHARP_EDGE else -3.16

    def niirs(self, gsd_m: float) -> float:
        """NIIRS at a ground sampled distance (equation 1, which counts it in inches)."""
        if not gsd_m > 0.0:
            raise ValueError(f"a ground sampled distance of {gsd_m:g} m is none")
        return self._rest + self.slope * math.log10(gsd_m / _METRES_AN_INCH)

    def largest_gsd_m(self, niirs: float) -> float:
        """The largest ground sampled distance that keeps a NIIRS (Algorithm 1)."""
        return float(10.0 ** ((niirs - self._rest) / self.slope)) * _METRES_AN_INCH

    @property
    def _rest(self) -> float:
        edge = 1.559 if self.rer >= _SHARP_EDGE else 2.817
        noise = _NOISE * self.noise_gain / self.snr
        return SENSOR_TYPE[self.spectrum] + edge * math.log10(self.rer) - noise - _OVERSHOOT * self.overshoot


def noise_gain(mask: Sequence[Sequence[float]]) -> float:
    """G of a filter's mask: the root of the sum of its squares (equations 7 and 8: √29)."""
    return math.sqrt(math.fsum(value * value for row in mask for value in row))


def signal_to_noise(mean: float, deviation: float) -> float:
    """SNR from a pixel's mean and standard deviation (equation 6)."""
    if not deviation > 0.0:
        raise ValueError("a deviation of nothing is no measurement of noise")
    return mean / deviation
