"""The addresses each vehicle's link is forwarded to."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"


def upgrade() -> None:
    """Create the column."""
    op.add_column("vehicles", sa.Column("forward", sa.JSON))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("vehicles", "forward")
