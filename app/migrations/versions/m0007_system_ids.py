"""Which system each vehicle is, so that another one in its place is noticed."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"


def upgrade() -> None:
    """Create the column."""
    op.add_column("vehicles", sa.Column("system_id", sa.Integer))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("vehicles", "system_id")
