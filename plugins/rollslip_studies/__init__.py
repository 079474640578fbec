"""Built-in studies: one question to one bearing each, one folder for each."""
