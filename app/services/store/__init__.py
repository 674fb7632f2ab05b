"""The database: tables, sessions, and one store per kind of thing."""
