"""Migrations of the database, run at each start of the service."""
