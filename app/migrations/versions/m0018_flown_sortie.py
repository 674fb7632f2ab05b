"""Which of its vehicle's flights in a plan a flight followed."""

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"


def upgrade() -> None:
    """Create the column."""
    op.add_column("flights", sa.Column("plan_sortie", sa.Integer()))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("flights", "plan_sortie")
