"""Study raceway-friction: force, friction and rolling resistance of both raceways over all speeds of a motion."""
