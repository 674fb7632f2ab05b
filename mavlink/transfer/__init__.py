"""Sans-I/O machines of the mission protocol: no socket, no clock."""
