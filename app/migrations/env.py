"""Run by alembic: migrate over the connection the service hands in."""

from alembic import context

from app.services.store.tables import Base

connection = context.config.attributes["connection"]
# SQLite changes columns only by copying the table, which batch mode does.
context.configure(connection=connection, target_metadata=Base.metadata, render_as_batch=True)
with context.begin_transaction():
    context.run_migrations()
