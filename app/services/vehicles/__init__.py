"""Connected vehicles: links, simulated aircraft, uploads, commands, flights as they happen."""
