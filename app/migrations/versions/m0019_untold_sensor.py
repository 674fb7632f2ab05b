"""Whether nothing told of the sensor where a track has a place.

Of flights whose sensor took videos and was never told to be on, nothing did.
"""

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"


def upgrade() -> None:
    """Create the column."""
    op.add_column("track_points", sa.Column("sensor_untold", sa.Boolean()))
    op.execute(
        "UPDATE track_points SET sensor_untold = 1 WHERE flight_id IN ("
        "SELECT id FROM flights WHERE payload LIKE '%trigger:video%' AND id NOT IN ("
        "SELECT flight_id FROM track_points WHERE sensor_on))"
    )


def downgrade() -> None:
    """Drop it."""
    op.drop_column("track_points", "sensor_untold")
