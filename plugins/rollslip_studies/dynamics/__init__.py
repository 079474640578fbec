"""Study dynamics: cage and rollers in time."""
