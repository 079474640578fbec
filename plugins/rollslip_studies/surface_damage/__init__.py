"""Study surface-damage: what slip does to the surfaces, by models of kind damage, and where it is worst."""
