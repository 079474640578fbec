"""What resists cage and rollers beside the raceways: torques on the cage, and resistance to rolling."""
