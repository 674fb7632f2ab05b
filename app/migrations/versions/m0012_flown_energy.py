"""What flights drew from their batteries, the pitch along their tracks, what onboard logs gave."""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"


def upgrade() -> None:
    """Create the columns."""
    op.add_column("flights", sa.Column("energy", sa.JSON))
    op.add_column("flights", sa.Column("logs", sa.JSON))
    op.add_column("track_points", sa.Column("pitch_deg", sa.Float))
    op.add_column("track_points", sa.Column("from_log", sa.Boolean))


def downgrade() -> None:
    """Drop them."""
    op.drop_column("track_points", "from_log")
    op.drop_column("track_points", "pitch_deg")
    op.drop_column("flights", "logs")
    op.drop_column("flights", "energy")
