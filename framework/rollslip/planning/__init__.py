"""How finely, with what error and at what cost a study is run."""
