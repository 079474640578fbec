"""Studies: what is asked of one scene, one folder for each."""
