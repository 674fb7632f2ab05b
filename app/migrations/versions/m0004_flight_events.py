"""How a flight's sensor was switched, and what it reported: photos and switches."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Create the table and the column."""
    op.add_column("flights", sa.Column("payload", sa.String(200)))
    op.create_table(
        "flight_events",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column(
            "flight_id", sa.String(36), sa.ForeignKey("flights.id", ondelete="CASCADE"), nullable=False
        ),
        sa.Column("time_s", sa.Float, nullable=False),
        sa.Column("kind", sa.String(8), nullable=False),
        sa.Column("source", sa.String(8), nullable=False),
        sa.Column("index", sa.Integer),
        sa.Column("lon_deg", sa.Float),
        sa.Column("lat_deg", sa.Float),
        sa.Column("altitude_amsl_m", sa.Float),
        sa.Column("altitude_home_m", sa.Float),
        sa.Column("heading_deg", sa.Float),
        sa.Column("roll_deg", sa.Float),
        sa.Column("pitch_deg", sa.Float),
    )
    op.create_index("ix_flight_events_flight", "flight_events", ["flight_id", "number"])


def downgrade() -> None:
    """Drop them."""
    op.drop_table("flight_events")
    op.drop_column("flights", "payload")
