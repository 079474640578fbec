"""What varies of a scene: which values there are, how they are distributed, and how they scatter by default."""
