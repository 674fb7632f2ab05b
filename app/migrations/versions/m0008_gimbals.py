"""How the gimbal of the mission a vehicle was seen to hold is pointed."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    """Create the column."""
    op.add_column("vehicles", sa.Column("held_gimbal", sa.String(200)))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("vehicles", "held_gimbal")
