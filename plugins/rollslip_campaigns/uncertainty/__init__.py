"""What scattered input does to the slip that is allowed."""
