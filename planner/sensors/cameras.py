"""Cameras in use, by the figures their makers publish.

Each row: name, kind, focal length in mm, width of the chip's used part in mm, columns, rows, shortest time
between photos in s (0: not published), and the maker's specifications or guide they stand in. The pixel pitch
is the width over the columns. A camera with lenses to change stands once for each lens that mapping uses.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from planner.named import named
from planner.sensors.optics import Optics
from planner.sensors.quality import Spectrum

Kind = Literal["mapping", "mirrorless", "multispectral", "thermal", "integrated", "compact"]


@dataclass(frozen=True, slots=True)
class Camera:
    """One camera with its lens.

    Parameters
    ----------
    name
        Maker, model and, where lenses are changed, the lens.
    kind
        What it is used as; ``integrated`` is that of a multirotor, gimbal included.
    optics
        Lens and chip, columns across the flight direction.
    min_interval_s
        Shortest time between two photos; 0 where the maker publishes none.
    source
        Where the figures are published.
    """

    name: str
    kind: Kind
    optics: Optics
    min_interval_s: float
    source: str

    @property
    def gimballed(self) -> bool:
        """Whether it hangs in a gimbal of its own, which keeps it level: all of DJI's do."""
        return self.kind == "integrated" or self.name.startswith("DJI ")

    @property
    def spectrum(self) -> Spectrum:
        """Thermal cameras see infrared; near infrared counts as light, by its chip."""
        return "infrared" if self.kind == "thermal" else "visible"


def hangs_level(model: str | None) -> bool:
    """Whether a camera of a model has a gimbal of its own; not where the model is none that is known."""
    return model is not None and model in CAMERAS and CAMERAS[model].gimballed


_Row = tuple[str, Kind, float, float, int, int, float, str]

_ROWS: tuple[_Row, ...] = (
    ("DJI Mavic 3 Enterprise wide", "integrated", 12.29, 17.3, 5280, 3956, 0.7, "DJI: Mavic 3 Enterprise"),
    ("DJI Mavic 3 Thermal", "thermal", 9.1, 7.68, 640, 512, 0.0, "DJI: Mavic 3 Thermal: 12 µm"),
    ("DJI Mavic 3 Multispectral", "multispectral", 4.34, 5.2, 2592, 1944, 2.0, "DJI: Mavic 3 Multispectral"),
    ("DJI Phantom 4 Pro", "integrated", 8.8, 13.2, 5472, 3648, 2.0, "DJI: Phantom 4 Pro"),
    ("DJI Phantom 4 RTK", "integrated", 8.8, 13.2, 5472, 3648, 2.5, "DJI: Phantom 4 RTK"),
    ("DJI Phantom 4 Multispectral", "multispectral", 5.74, 4.8, 1600, 1300, 2.0, "DJI: P4 Multispectral"),
    ("DJI Mavic 2 Pro", "integrated", 10.26, 13.2, 5472, 3648, 2.0, "DJI: Mavic 2 Pro (Hasselblad L1D-20c)"),
    ("DJI Air 2S", "integrated", 8.38, 13.2, 5472, 3648, 2.0, "DJI: Air 2S"),
    ("DJI Mini 3 Pro", "integrated", 6.72, 9.65, 4032, 3024, 2.0, "DJI: Mini 3 Pro"),
    ("DJI Matrice 30 wide", "integrated", 4.5, 6.4, 4000, 3000, 0.7, "DJI: Matrice 30 series"),
    ("DJI Matrice 30T thermal", "thermal", 9.1, 7.68, 640, 512, 0.0, "DJI: Matrice 30T: 12 µm"),
    ("DJI Zenmuse P1 24 mm", "mapping", 24.0, 35.9, 8192, 5460, 0.7, "DJI: Zenmuse P1"),
    ("DJI Zenmuse P1 35 mm", "mapping", 35.0, 35.9, 8192, 5460, 0.7, "DJI: Zenmuse P1"),
    ("DJI Zenmuse P1 50 mm", "mapping", 50.0, 35.9, 8192, 5460, 0.7, "DJI: Zenmuse P1"),
    ("DJI Zenmuse L1", "mapping", 8.8, 13.2, 5472, 3648, 2.0, "DJI: Zenmuse L1, its camera"),
    ("DJI Zenmuse X4S", "integrated", 8.8, 13.2, 5472, 3648, 2.0, "DJI: Zenmuse X4S"),
    ("DJI Zenmuse X5S 15 mm", "integrated", 15.0, 17.3, 5280, 3956, 2.0, "DJI: Zenmuse X5S"),
    ("DJI Zenmuse X7 24 mm", "integrated", 24.0, 23.5, 6016, 4008, 2.0, "DJI: Zenmuse X7"),
    ("DJI Zenmuse H20 wide", "integrated", 4.5, 6.17, 4056, 3040, 2.0, "DJI: Zenmuse H20 series"),
    ("DJI Zenmuse H20T thermal", "thermal", 13.5, 7.68, 640, 512, 0.0, "DJI: Zenmuse H20T: 12 µm"),
    ("DJI Zenmuse XT2 13 mm", "thermal", 13.0, 10.88, 640, 512, 0.0, "DJI: Zenmuse XT2: 17 µm"),
    ("DJI Zenmuse XT2 19 mm", "thermal", 19.0, 10.88, 640, 512, 0.0, "DJI: Zenmuse XT2: 17 µm"),
    ("senseFly S.O.D.A.", "mapping", 10.6, 12.75, 5472, 3648, 0.0, "senseFly: S.O.D.A."),
    ("senseFly Aeria X", "mapping", 18.5, 23.5, 6000, 4000, 0.0, "senseFly: Aeria X"),
    ("Phase One iXM-100 35 mm", "mapping", 35.0, 43.9, 11664, 8750, 0.33, "Phase One: iXM-100"),
    ("Phase One iXM-100 80 mm", "mapping", 80.0, 43.9, 11664, 8750, 0.33, "Phase One: iXM-100"),
    ("Phase One iXM-50 50 mm", "mapping", 50.0, 43.9, 8280, 6208, 0.5, "Phase One: iXM-50"),
    ("Hasselblad A6D-100c 50 mm", "mapping", 50.0, 53.4, 11600, 8700, 1.0, "Hasselblad: A6D-100c"),
    ("Sentera 65R", "mapping", 27.4, 29.9, 9344, 7000, 0.3, "Sentera: 65R"),
    ("Sony RX1R II", "compact", 35.0, 35.9, 7952, 5304, 1.0, "Sony: DSC-RX1RM2"),
    ("Sony RX0", "compact", 7.7, 13.2, 4800, 3200, 0.0, "Sony: DSC-RX0"),
    ("Sony a6000 16 mm", "mirrorless", 16.0, 23.5, 6000, 4000, 1.0, "Sony: ILCE-6000"),
    ("Sony a6000 20 mm", "mirrorless", 20.0, 23.5, 6000, 4000, 1.0, "Sony: ILCE-6000"),
    ("Sony a6000 35 mm", "mirrorless", 35.0, 23.5, 6000, 4000, 1.0, "Sony: ILCE-6000"),
    ("Sony a6100 20 mm", "mirrorless", 20.0, 23.5, 6000, 4000, 1.0, "Sony: ILCE-6100"),
    ("Sony a6300 28 mm", "mirrorless", 28.0, 23.5, 6000, 4000, 1.0, "Sony: ILCE-6300"),
    ("Sony a7R II 28 mm", "mirrorless", 28.0, 35.9, 7952, 5304, 1.0, "Sony: ILCE-7RM2"),
    ("Sony a7R III 35 mm", "mirrorless", 35.0, 35.9, 7952, 5304, 1.0, "Sony: ILCE-7RM3"),
    ("Sony a7R IV 35 mm", "mirrorless", 35.0, 35.7, 9504, 6336, 1.0, "Sony: ILCE-7RM4"),
    ("Sony QX1 16 mm", "mirrorless", 16.0, 23.2, 5456, 3632, 0.0, "Sony: ILCE-QX1"),
    ("Sony NEX-5R 20 mm", "mirrorless", 20.0, 23.4, 4912, 3264, 1.0, "Sony: NEX-5R"),
    ("Sony RX100 II", "compact", 10.4, 13.2, 5472, 3648, 0.0, "Sony: DSC-RX100M2"),
    ("Canon EOS M 22 mm", "mirrorless", 22.0, 22.3, 5184, 3456, 0.0, "Canon: EOS M"),
    ("Canon PowerShot S100", "compact", 5.2, 7.44, 4000, 3000, 0.0, "Canon: PowerShot S100"),
    ("Canon PowerShot SX260 HS", "compact", 4.5, 6.17, 4000, 3000, 0.0, "Canon: PowerShot SX260 HS"),
    ("Canon PowerShot G9 X", "compact", 10.2, 13.2, 5472, 3648, 0.0, "Canon: PowerShot G9 X"),
    ("Ricoh GR II", "compact", 18.3, 23.7, 4928, 3264, 0.0, "Ricoh: GR II"),
    ("Ricoh GR III", "compact", 18.3, 23.5, 6000, 4000, 0.0, "Ricoh: GR III"),
    ("MicaSense RedEdge-MX", "multispectral", 5.4, 4.8, 1280, 960, 1.0, "MicaSense: RedEdge-MX guide"),
    ("MicaSense Altum", "multispectral", 8.0, 7.12, 2064, 1544, 1.0, "MicaSense: Altum guide"),
    ("Parrot Sequoia", "multispectral", 3.98, 4.8, 1280, 960, 0.5, "Parrot: Sequoia guide, single bands"),
    ("Parrot Sequoia RGB", "compact", 4.88, 6.17, 4608, 3456, 1.0, "Parrot: Sequoia guide, RGB"),
    ("Sentera 6X", "multispectral", 8.0, 6.57, 1904, 1428, 0.2, "Sentera: 6X"),
    ("FLIR Vue Pro R 640 13 mm", "thermal", 13.0, 10.88, 640, 512, 0.0, "FLIR: Vue Pro R: 17 µm"),
    ("FLIR Vue Pro R 640 19 mm", "thermal", 19.0, 10.88, 640, 512, 0.0, "FLIR: Vue Pro R: 17 µm"),
    ("FLIR Duo Pro R 640 19 mm", "thermal", 19.0, 10.88, 640, 512, 1.0, "FLIR: Duo Pro R: 17 µm"),
    ("Yuneec E90", "integrated", 8.29, 13.2, 5472, 3648, 1.3, "Yuneec: E90"),
)  # fmt: skip

CAMERAS: dict[str, Camera] = {
    name: Camera(
        name,
        kind,
        Optics(focal_mm / 1000.0, width_mm / 1000.0 / columns, columns, rows),
        interval_s,
        source,
    )
    for name, kind, focal_mm, width_mm, columns, rows, interval_s, source in _ROWS
}


def find_camera(name: str) -> Camera:
    """A camera by its name, case aside.

    Raises
    ------
    KeyError
        None is called so; its argument says which come near.
    """
    return named(CAMERAS, name, "camera", "swathplan sensors")
