"""Which of its flights in a plan the mission a vehicle was seen to hold is."""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"


def upgrade() -> None:
    """Create the column."""
    op.add_column("vehicles", sa.Column("held_sortie", sa.Integer()))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("vehicles", "held_sortie")
