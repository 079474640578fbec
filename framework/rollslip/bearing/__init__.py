"""One bearing put together, at rest: contacts, loads, kinematics, cage and resolution."""
