"""What was ordered of vehicles, by whom, and what became of it."""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"


def upgrade() -> None:
    """Create the table."""
    op.create_table(
        "audit",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("at", sa.String(32), nullable=False, index=True),
        sa.Column("actor", sa.String(200), nullable=False),
        sa.Column("kind", sa.String(20), nullable=False),
        sa.Column("vehicle_id", sa.String(36), nullable=False, index=True),
        sa.Column("vehicle_name", sa.String(200), nullable=False),
        sa.Column("what", sa.JSON, nullable=False),
        sa.Column("outcome", sa.String(20), nullable=False),
        sa.Column("reason", sa.Text, nullable=False),
        sa.Column("ended_at", sa.String(32)),
    )


def downgrade() -> None:
    """Drop it."""
    op.drop_table("audit")
