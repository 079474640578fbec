"""Studies: what a study is, what all of them ask for, and the models that only one of them uses."""
