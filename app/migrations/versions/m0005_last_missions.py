"""The mission last sent to each vehicle, and the id the vehicle gave it."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Create the columns."""
    op.add_column("vehicles", sa.Column("last_plan_id", sa.String(36)))
    op.add_column("vehicles", sa.Column("last_list_id", sa.Integer))


def downgrade() -> None:
    """Drop them."""
    op.drop_column("vehicles", "last_list_id")
    op.drop_column("vehicles", "last_plan_id")
