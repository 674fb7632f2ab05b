"""What the service did by itself during a flight."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"


def upgrade() -> None:
    """Create the column."""
    op.add_column("flights", sa.Column("actions", sa.JSON))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("flights", "actions")
