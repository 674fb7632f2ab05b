"""Scenarios kept by the service, and which of them a plan was made of."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"


def upgrade() -> None:
    """Create the table and the columns."""
    op.create_table(
        "scenarios",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("id", sa.String(36), nullable=False, unique=True),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("revision", sa.Integer, nullable=False),
        sa.Column("scenario_hash", sa.String(64), nullable=False),
        sa.Column("document", sa.Text, nullable=False),
        sa.Column("created_at", sa.String(32), nullable=False),
        sa.Column("changed_at", sa.String(32), nullable=False),
    )
    op.add_column("plans", sa.Column("scenario_id", sa.String(36)))
    op.add_column("plans", sa.Column("scenario_hash", sa.String(64)))


def downgrade() -> None:
    """Drop them."""
    op.drop_column("plans", "scenario_hash")
    op.drop_column("plans", "scenario_id")
    op.drop_table("scenarios")
