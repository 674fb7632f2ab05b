"""Assignment at scale: ruin and recreate over the exact costs and limits of every aircraft."""
