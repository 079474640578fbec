"""Study effective-friction: friction of each raceway as a whole over cage slip."""
