"""Areas with obstacles seen from straight down: footprint sweeps, cells, and the lines that join them."""
