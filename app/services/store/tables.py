"""Tables. Changing one needs a migration in ``app/migrations/versions``."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import JSON, Boolean, Float, ForeignKey, Index, Integer, String, Text
from sqlalchemy.engine import Dialect
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column
from sqlalchemy.types import TypeDecorator


class UtcTime(TypeDecorator[datetime]):
    """A moment, kept as ISO 8601 text in UTC: SQLite itself knows no time zones."""

    impl = String(32)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> str | None:
        """Write UTC."""
        return None if value is None else value.astimezone(UTC).isoformat(timespec="microseconds")

    def process_result_value(self, value: Any | None, dialect: Dialect) -> datetime | None:
        """Read UTC."""
        return None if value is None else datetime.fromisoformat(value)


class Base(DeclarativeBase):
    """Base of the tables."""


class PlanRow(Base):
    """One request to plan and what became of it."""

    __tablename__ = "plans"

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(36), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    state: Mapped[str] = mapped_column(String(12), index=True)
    stage: Mapped[str | None] = mapped_column(String(64))
    progress: Mapped[float] = mapped_column(Float)
    created_at: Mapped[datetime] = mapped_column(UtcTime)
    started_at: Mapped[datetime | None] = mapped_column(UtcTime)
    ended_at: Mapped[datetime | None] = mapped_column(UtcTime)
    idempotency_key: Mapped[str | None] = mapped_column(String(200), unique=True)
    body_sha256: Mapped[str] = mapped_column(String(64))
    warnings: Mapped[list[dict[str, Any]]] = mapped_column(JSON)
    summary: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    error: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    scenario_id: Mapped[str | None] = mapped_column(String(36))
    scenario_hash: Mapped[str | None] = mapped_column(String(64))


class ScenarioRow(Base):
    """One scenario people are at work on; it may be unfinished. Plans keep copies of their own."""

    __tablename__ = "scenarios"

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(36), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    revision: Mapped[int] = mapped_column(Integer)
    scenario_hash: Mapped[str] = mapped_column(String(64))
    document: Mapped[str] = mapped_column(Text)
    created_at: Mapped[datetime] = mapped_column(UtcTime)
    changed_at: Mapped[datetime] = mapped_column(UtcTime)


class PlanDocumentRow(Base):
    """The large texts of a plan, kept apart so that lists stay quick."""

    __tablename__ = "plan_documents"

    plan_id: Mapped[str] = mapped_column(
        String(36), ForeignKey("plans.id", ondelete="CASCADE"), primary_key=True
    )
    scenario: Mapped[str] = mapped_column(Text)
    plan: Mapped[str | None] = mapped_column(Text)


class VehicleRow(Base):
    """One vehicle that was added, and the plan it was last seen to hold."""

    __tablename__ = "vehicles"

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(36), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    url: Mapped[str] = mapped_column(String(300))
    created_at: Mapped[datetime] = mapped_column(UtcTime)
    held_plan_id: Mapped[str | None] = mapped_column(String(36))
    held_plan_vehicle: Mapped[str | None] = mapped_column(String(200))
    held_payload: Mapped[str | None] = mapped_column(String(200))
    held_gimbal: Mapped[str | None] = mapped_column(String(200))
    held_arcs: Mapped[str | None] = mapped_column(String(10))
    held_chord_error_m: Mapped[float | None] = mapped_column(Float)
    held_sortie: Mapped[int | None] = mapped_column(Integer)
    last_plan_id: Mapped[str | None] = mapped_column(String(36))
    last_list_id: Mapped[int | None] = mapped_column(Integer)
    forward: Mapped[list[dict[str, Any]] | None] = mapped_column(JSON)
    system_id: Mapped[int | None] = mapped_column(Integer)


class UploadRow(Base):
    """One upload to a vehicle: what was meant, how it ended, who overrode what."""

    __tablename__ = "uploads"

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    vehicle_id: Mapped[str] = mapped_column(String(36), index=True)
    vehicle_name: Mapped[str] = mapped_column(String(200))
    plan_id: Mapped[str] = mapped_column(String(36), index=True)
    parts: Mapped[list[str]] = mapped_column(JSON)
    outcome: Mapped[str] = mapped_column(String(12))
    override_reason: Mapped[str | None] = mapped_column(Text)
    detail: Mapped[dict[str, Any]] = mapped_column(JSON)
    started_at: Mapped[datetime] = mapped_column(UtcTime)
    ended_at: Mapped[datetime | None] = mapped_column(UtcTime)


class AuditRow(Base):
    """What somebody ordered of a vehicle, written before it was sent, and what became of it."""

    __tablename__ = "audit"

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    at: Mapped[datetime] = mapped_column(UtcTime, index=True)
    actor: Mapped[str] = mapped_column(String(200))
    kind: Mapped[str] = mapped_column(String(20))
    vehicle_id: Mapped[str] = mapped_column(String(36), index=True)
    vehicle_name: Mapped[str] = mapped_column(String(200))
    what: Mapped[dict[str, Any]] = mapped_column(JSON)
    outcome: Mapped[str] = mapped_column(String(20))
    reason: Mapped[str] = mapped_column(Text)
    ended_at: Mapped[datetime | None] = mapped_column(UtcTime)


class FlightRow(Base):
    """One flight, from the first movement of an armed vehicle to its disarming."""

    __tablename__ = "flights"

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(36), unique=True)
    vehicle_id: Mapped[str] = mapped_column(String(36), index=True)
    vehicle_name: Mapped[str] = mapped_column(String(200))
    plan_id: Mapped[str | None] = mapped_column(String(36), index=True)
    plan_vehicle: Mapped[str | None] = mapped_column(String(200))
    plan_sortie: Mapped[int | None] = mapped_column(Integer)
    payload: Mapped[str | None] = mapped_column(String(200))
    state: Mapped[str] = mapped_column(String(12))
    started_at: Mapped[datetime] = mapped_column(UtcTime)
    ended_at: Mapped[datetime | None] = mapped_column(UtcTime)
    actions: Mapped[list[dict[str, Any]] | None] = mapped_column(JSON)
    energy: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    logs: Mapped[list[str] | None] = mapped_column(JSON)
    link: Mapped[list[dict[str, Any]] | None] = mapped_column(JSON)


class TrackPointRow(Base):
    """One recorded place of a flight."""

    __tablename__ = "track_points"
    __table_args__ = (Index("ix_track_points_flight", "flight_id", "number"),)

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    flight_id: Mapped[str] = mapped_column(String(36), ForeignKey("flights.id", ondelete="CASCADE"))
    time_s: Mapped[float] = mapped_column(Float)
    lon_deg: Mapped[float] = mapped_column(Float)
    lat_deg: Mapped[float] = mapped_column(Float)
    altitude_amsl_m: Mapped[float | None] = mapped_column(Float)
    altitude_home_m: Mapped[float | None] = mapped_column(Float)
    heading_deg: Mapped[float | None] = mapped_column(Float)
    roll_deg: Mapped[float | None] = mapped_column(Float)
    ground_speed_m_s: Mapped[float | None] = mapped_column(Float)
    mission_seq: Mapped[int | None] = mapped_column(Integer)
    sensor_on: Mapped[bool] = mapped_column(Boolean)
    sensor_untold: Mapped[bool | None] = mapped_column(Boolean)
    pitch_deg: Mapped[float | None] = mapped_column(Float)
    from_log: Mapped[bool | None] = mapped_column(Boolean)
    mount_roll_deg: Mapped[float | None] = mapped_column(Float)
    mount_pitch_deg: Mapped[float | None] = mapped_column(Float)
    mount_yaw_deg: Mapped[float | None] = mapped_column(Float)


class FlightEventRow(Base):
    """A photo, or a switch of the sensor, of one flight."""

    __tablename__ = "flight_events"
    __table_args__ = (Index("ix_flight_events_flight", "flight_id", "number"),)

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    flight_id: Mapped[str] = mapped_column(String(36), ForeignKey("flights.id", ondelete="CASCADE"))
    time_s: Mapped[float] = mapped_column(Float)
    kind: Mapped[str] = mapped_column(String(8))
    source: Mapped[str] = mapped_column(String(8))
    index: Mapped[int | None] = mapped_column(Integer)
    lon_deg: Mapped[float | None] = mapped_column(Float)
    lat_deg: Mapped[float | None] = mapped_column(Float)
    altitude_amsl_m: Mapped[float | None] = mapped_column(Float)
    altitude_home_m: Mapped[float | None] = mapped_column(Float)
    heading_deg: Mapped[float | None] = mapped_column(Float)
    roll_deg: Mapped[float | None] = mapped_column(Float)
    pitch_deg: Mapped[float | None] = mapped_column(Float)
    attitude_of: Mapped[str | None] = mapped_column(String(9))


class TerrainRow(Base):
    """One uploaded elevation raster; its posts are in a file."""

    __tablename__ = "terrains"

    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(36), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    west_deg: Mapped[float] = mapped_column(Float)
    south_deg: Mapped[float] = mapped_column(Float)
    east_deg: Mapped[float] = mapped_column(Float)
    north_deg: Mapped[float] = mapped_column(Float)
    resolution_m: Mapped[float] = mapped_column(Float)
    rows: Mapped[int] = mapped_column(Integer)
    columns: Mapped[int] = mapped_column(Integer)
    min_m: Mapped[float] = mapped_column(Float)
    max_m: Mapped[float] = mapped_column(Float)
    known_fraction: Mapped[float] = mapped_column(Float)
    datum: Mapped[str] = mapped_column(String(100))
    sha256: Mapped[str] = mapped_column(String(64), index=True)
    created_at: Mapped[datetime] = mapped_column(UtcTime)
