"""Plans, uploads, flights and their tracks."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Create the tables."""
    op.create_table(
        "plans",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("id", sa.String(36), nullable=False, unique=True),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("state", sa.String(12), nullable=False, index=True),
        sa.Column("stage", sa.String(64)),
        sa.Column("progress", sa.Float, nullable=False),
        sa.Column("created_at", sa.String(32), nullable=False),
        sa.Column("started_at", sa.String(32)),
        sa.Column("ended_at", sa.String(32)),
        sa.Column("idempotency_key", sa.String(200), unique=True),
        sa.Column("body_sha256", sa.String(64), nullable=False),
        sa.Column("warnings", sa.JSON, nullable=False),
        sa.Column("summary", sa.JSON),
        sa.Column("error", sa.JSON),
    )
    op.create_table(
        "plan_documents",
        sa.Column("plan_id", sa.String(36), sa.ForeignKey("plans.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("scenario", sa.Text, nullable=False),
        sa.Column("plan", sa.Text),
    )
    op.create_table(
        "uploads",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("vehicle_id", sa.String(36), nullable=False, index=True),
        sa.Column("vehicle_name", sa.String(200), nullable=False),
        sa.Column("plan_id", sa.String(36), nullable=False, index=True),
        sa.Column("parts", sa.JSON, nullable=False),
        sa.Column("outcome", sa.String(12), nullable=False),
        sa.Column("override_reason", sa.Text),
        sa.Column("detail", sa.JSON, nullable=False),
        sa.Column("started_at", sa.String(32), nullable=False),
        sa.Column("ended_at", sa.String(32)),
    )
    op.create_table(
        "flights",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("id", sa.String(36), nullable=False, unique=True),
        sa.Column("vehicle_id", sa.String(36), nullable=False, index=True),
        sa.Column("vehicle_name", sa.String(200), nullable=False),
        sa.Column("plan_id", sa.String(36), index=True),
        sa.Column("plan_vehicle", sa.String(200)),
        sa.Column("state", sa.String(12), nullable=False),
        sa.Column("started_at", sa.String(32), nullable=False),
        sa.Column("ended_at", sa.String(32)),
    )
    op.create_table(
        "track_points",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column(
            "flight_id", sa.String(36), sa.ForeignKey("flights.id", ondelete="CASCADE"), nullable=False
        ),
        sa.Column("time_s", sa.Float, nullable=False),
        sa.Column("lon_deg", sa.Float, nullable=False),
        sa.Column("lat_deg", sa.Float, nullable=False),
        sa.Column("altitude_amsl_m", sa.Float),
        sa.Column("altitude_home_m", sa.Float),
        sa.Column("heading_deg", sa.Float),
        sa.Column("roll_deg", sa.Float),
        sa.Column("ground_speed_m_s", sa.Float),
        sa.Column("mission_seq", sa.Integer),
        sa.Column("sensor_on", sa.Boolean, nullable=False),
    )
    op.create_index("ix_track_points_flight", "track_points", ["flight_id", "number"])


def downgrade() -> None:
    """Drop them all."""
    for table in ("track_points", "flights", "uploads", "plan_documents", "plans"):
        op.drop_table(table)
