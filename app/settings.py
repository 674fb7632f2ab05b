"""Settings of the service: environment variables with the prefix ``SWATHPLAN_``, or keyword arguments."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import Field, field_validator, model_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

from app.hosts import is_loopback, is_place

PACKAGE = Path(__file__).resolve().parent


def _spare_cores() -> int:
    return max(1, (os.cpu_count() or 2) - 1)


LinkKind = Literal["udpin", "udpout", "tcp", "tcpin", "serial", "sim", "replay"]

#: What a browser sends as Origin: no path, not even a slash; "null" is what any sandboxed page sends.
_ORIGIN = re.compile(r"https?://([A-Za-z0-9._-]+|\[[0-9A-Fa-f:]+\])(:[0-9]{1,5})?")
#: What the names of environment variables begin with.
PREFIX = "SWATHPLAN_"
#: Variables of the tests, which are no settings of the service.
_OF_TESTS = ("SWATHPLAN_TEST_", "SWATHPLAN_ARDU", "SWATHPLAN_PX4", "SWATHPLAN_SCREENSHOT")
#: Secrets are no settings: those are printed, compared and handed on.
_OF_KEYS = re.compile(PREFIX + r"SIGNING_KEY(_.+)?")


def unknown_variables() -> tuple[str, ...]:
    """Environment variables that look like settings and are none: most often a slip."""
    known = {PREFIX + name.upper() for name in Settings.model_fields}
    given = (name.upper() for name in os.environ if name.upper().startswith(PREFIX))
    ours = (name for name in given if name not in known and not _OF_KEYS.fullmatch(name))
    return tuple(sorted(name for name in ours if not name.startswith(_OF_TESTS)))


class Settings(BaseSettings):
    """How one service runs. Built by the caller and handed to ``create_app``; never a global."""

    model_config = SettingsConfigDict(env_prefix=PREFIX, extra="ignore", frozen=True)

    host: str = Field(default="127.0.0.1", description="Address to listen on.")
    port: int = Field(default=8000, ge=0, le=65535, description="TCP port to listen on; 0 takes a free one.")
    allow_remote: bool = Field(
        default=False,
        description="Listen beyond this machine, the service and vehicles' links, although the service knows "
        "no users: whoever reaches it commands the vehicles.",
    )
    allowed_hosts: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(),
        description="Host names, beyond this machine's own, that requests may be addressed to; with commas "
        "between them.",
    )
    allowed_origins: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(),
        description="Origins whose pages may send requests, and so command vehicles, beside the service's "
        "own: `https://ops.example:8443`, with commas between them. Needed where a proxy before the service "
        "changes the `Host` header.",
    )
    link_kinds: Annotated[tuple[LinkKind, ...], NoDecode] = Field(
        default=get_args(LinkKind),
        description="Kinds of links that requests may open; with commas between them.",
    )
    link_hosts: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(),
        description="Hosts, beyond this machine, that links of requests may call: names, addresses, networks "
        "(`192.168.1.0/24`), with commas between them. Links that listen beyond this machine need "
        "`SWATHPLAN_ALLOW_REMOTE`.",
    )
    serial_ports: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(),
        description="Serial ports that requests may open, `*` for any name: `/dev/ttyACM*`; with commas "
        "between them.",
    )
    replay_folders: Annotated[tuple[Path, ...], NoDecode] = Field(
        default=(),
        description="Folders whose recordings requests may watch, beside the service's own, with commas "
        "between them; any recording when there are none.",
    )
    database: Path = Field(default=Path("var/swathplan.db"), description="Database file; made when absent.")
    workers: int = Field(
        default_factory=_spare_cores,
        ge=1,
        le=256,
        description="Planning processes; the cores but one when unset.",
    )
    plan_time_limit_s: float = Field(default=600.0, gt=0, description="Longest time one plan may take.")
    max_queued_plans: int = Field(
        default=200, ge=1, description="Plans that may wait; more are refused with 429."
    )
    plan_memory_bytes: int = Field(
        default=8_000_000_000, ge=500_000_000, description="Most memory that one plan may take."
    )
    request_workers: int = Field(
        default=3,
        ge=2,
        le=64,
        description="Processes for what requests compute beside plans: validation, imports, rasters, "
        "exports, reports, what was seen; one of them is kept for missions on their way to a vehicle.",
    )
    request_time_limit_s: float = Field(
        default=30.0,
        gt=0,
        description="Longest time one such request may take; longer ones are refused.",
    )
    request_memory_bytes: int = Field(
        default=2_000_000_000, ge=200_000_000, description="Most memory one such request may take."
    )
    max_wait_s: float = Field(
        default=300.0, ge=0, description="Longest `?wait=` of a request; longer ones are cut to it."
    )
    max_body_bytes: int = Field(default=5_000_000, ge=1024, description="Largest request body.")
    max_terrain_bytes: int = Field(default=100_000_000, ge=1024, description="Largest elevation file.")
    max_log_bytes: int = Field(default=200_000_000, ge=1024, description="Largest onboard log of a flight.")
    static_dir: Path | None = Field(
        default=None, description="Folder of the built web map; found by itself when unset."
    )
    log_level: Literal["debug", "info", "warning", "error"] = Field(
        default="info", description="Messages of less weight are not logged."
    )
    track_interval_s: float = Field(
        default=0.2, gt=0, description="Vehicle time between two recorded points of a track."
    )
    signing_keys: Path | None = Field(
        default=None,
        description="File of the keys that vehicles sign with, lines `name = key`; only its owner may read "
        "it. Keys may also be given in `SWATHPLAN_SIGNING_KEY_<NAME>`, docs/security.md.",
    )
    record_links: bool = Field(default=True, description="Record every vehicle's link as .tlog files.")
    log_dir: Path | None = Field(
        default=None, description="Folder of the recordings; `logs` beside the database when unset."
    )
    log_file_bytes: int = Field(default=64_000_000, ge=100_000, description="Size at which a file is closed.")
    log_total_bytes: int = Field(
        default=2_000_000_000, ge=1_000_000, description="Size of all recordings; the oldest go first."
    )

    @field_validator(
        "allowed_hosts",
        "allowed_origins",
        "link_kinds",
        "link_hosts",
        "serial_ports",
        "replay_folders",
        mode="before",
    )
    @classmethod
    def _split(cls, value: Any) -> Any:
        return (
            tuple(filter(None, (name.strip() for name in value.split(","))))
            if isinstance(value, str)
            else value
        )

    @field_validator("allowed_origins")
    @classmethod
    def _origins(cls, origins: tuple[str, ...]) -> tuple[str, ...]:
        for origin in origins:
            if not _ORIGIN.fullmatch(origin):
                raise ValueError(
                    f"{origin} is no origin: write scheme, host and port and nothing behind them, as in "
                    "https://ops.example:8443"
                )
        return tuple(origin.lower() for origin in origins)

    @field_validator("link_hosts")
    @classmethod
    def _places(cls, places: tuple[str, ...]) -> tuple[str, ...]:
        for place in places:
            if not is_place(place):
                raise ValueError(
                    f"{place} is no host: write a name, an address or a network, as in 192.168.1.0/24"
                )
        return places

    @model_validator(mode="after")
    def _refuse_unsafe(self) -> Self:
        if not is_loopback(self.host) and not self.allow_remote:
            raise ValueError(
                f"host {self.host} can be reached from other machines and the service has no users or "
                "passwords: whoever reaches it can command the vehicles. Put it behind a proxy that asks who "
                "comes, then set SWATHPLAN_ALLOW_REMOTE=true"
            )
        return self

    @property
    def web_map(self) -> Path | None:
        """Folder of the built web map, None when it has not been built."""
        candidates = (
            (self.static_dir,)
            if self.static_dir is not None
            else (PACKAGE / "static_dist", PACKAGE.parent / "static" / "dist")
        )
        return next((folder for folder in candidates if (folder / "index.html").is_file()), None)
