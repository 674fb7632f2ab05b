"""Whose attitude a photo tells: the airframe's or the camera's own."""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"


def upgrade() -> None:
    """Create the column."""
    op.add_column("flight_events", sa.Column("attitude_of", sa.String(9)))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("flight_events", "attitude_of")
