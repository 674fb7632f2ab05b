"""Where a gimbal pointed along a track."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"

COLUMNS = ("mount_roll_deg", "mount_pitch_deg", "mount_yaw_deg")


def upgrade() -> None:
    """Create the columns."""
    for name in COLUMNS:
        op.add_column("track_points", sa.Column(name, sa.Float))


def downgrade() -> None:
    """Drop them."""
    for name in reversed(COLUMNS):
        op.drop_column("track_points", name)
