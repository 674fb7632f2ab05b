"""Vehicles that were added, to be listened for again after a restart."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Create the table."""
    op.create_table(
        "vehicles",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("id", sa.String(36), nullable=False, unique=True),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("url", sa.String(300), nullable=False),
        sa.Column("created_at", sa.String(32), nullable=False),
        sa.Column("held_plan_id", sa.String(36)),
        sa.Column("held_plan_vehicle", sa.String(200)),
        sa.Column("held_payload", sa.String(200)),
    )


def downgrade() -> None:
    """Drop it."""
    op.drop_table("vehicles")
