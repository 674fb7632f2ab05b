"""When the links of flights were lost and came back."""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"


def upgrade() -> None:
    """Create the column."""
    op.add_column("flights", sa.Column("link", sa.JSON))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("flights", "link")
