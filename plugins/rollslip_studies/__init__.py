"""Studies of the box: one question to one bearing each, one folder for each."""
