"""How the arcs of the mission a vehicle was seen to hold are said."""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"


def upgrade() -> None:
    """Create the columns."""
    op.add_column("vehicles", sa.Column("held_arcs", sa.String(10)))
    op.add_column("vehicles", sa.Column("held_chord_error_m", sa.Float()))


def downgrade() -> None:
    """Drop them."""
    op.drop_column("vehicles", "held_chord_error_m")
    op.drop_column("vehicles", "held_arcs")
