"""What a plan's camera surveys are like, in a line each."""

from __future__ import annotations

from typing import Any

from app.cli.output import say


def tell_surveys(document: dict[str, Any]) -> None:
    """Say of each region that a camera sees: passes, photos, height, size of a pixel, overlaps, time."""
    features = [feature["properties"] | {"at": feature["geometry"]} for feature in document["features"]]
    collects = {(f["vehicle"], f["seq"]): f for f in features if f["role"] == "collect"}
    homes_m = {f["vehicle"]: f["at"]["coordinates"][0][2] for f in features if f["role"] == "path"}
    # Flights that begin in the air say how high their home is.
    homes_m |= {v["name"]: v["home_altitude_m"] for v in document["vehicles"] if "home_altitude_m" in v}
    counts = {(f["vehicle"], f["seq"]): f["count"] for f in features if f["role"] == "photos"}
    for roi, survey in (document["metrics"].get("surveys") or {}).items():
        own = {key: f for key, f in collects.items() if roi in f["rois"]}
        if not own:
            continue
        heights_m = [
            place[2] - homes_m[f["vehicle"]] for f in own.values() for place in f["at"]["coordinates"]
        ]
        low_m, high_m = min(heights_m), max(heights_m)
        height = f"{low_m:.0f} m" if high_m - low_m < 1.0 else f"{low_m:.0f} to {high_m:.0f} m"
        photos = sum(counts.get(key, 0) for key in own)
        took_s = max(f["end_s"] for f in own.values()) - min(f["start_s"] for f in own.values())
        say(
            f"{roi}: {len(own)} {'pass' if len(own) == 1 else 'passes'}"
            + (f", {photos} photos" if photos else ", a video")
            + f" from {height} over home, {_centimetres(survey['gsd_m'])} a pixel at worst"
            + _niirs(survey["niirs"])
            + "; overlaps at least "
            + (f"{survey['forward_overlap']:.0%} forward and " if photos else "")
            + f"{survey['side_overlap']:.0%} to the side; {took_s / 60:.1f} min from first to last"
        )


def _centimetres(gsd_m: float) -> str:
    return f"{100.0 * gsd_m:.2g} cm" if gsd_m < 1.0 else f"{gsd_m:.3g} m"


def _niirs(niirs: float | None) -> str:
    return "" if niirs is None else f" (NIIRS {niirs:.1f})"
