"""The process that holds the links, as the service keeps it."""
