"""Uploaded elevation rasters."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Create the table."""
    op.create_table(
        "terrains",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("id", sa.String(36), nullable=False, unique=True),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("west_deg", sa.Float, nullable=False),
        sa.Column("south_deg", sa.Float, nullable=False),
        sa.Column("east_deg", sa.Float, nullable=False),
        sa.Column("north_deg", sa.Float, nullable=False),
        sa.Column("resolution_m", sa.Float, nullable=False),
        sa.Column("rows", sa.Integer, nullable=False),
        sa.Column("columns", sa.Integer, nullable=False),
        sa.Column("min_m", sa.Float, nullable=False),
        sa.Column("max_m", sa.Float, nullable=False),
        sa.Column("known_fraction", sa.Float, nullable=False),
        sa.Column("datum", sa.String(100), nullable=False),
        sa.Column("sha256", sa.String(64), nullable=False, index=True),
        sa.Column("created_at", sa.String(32), nullable=False),
    )


def downgrade() -> None:
    """Drop it."""
    op.drop_table("terrains")
