"""The compiled laws: what a slice's law is stands in a header of blocks, the module beside it makes its stage."""
