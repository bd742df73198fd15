"""Everything that is kept, in one database: SQLite in the data folder, or PostgreSQL by URL."""
