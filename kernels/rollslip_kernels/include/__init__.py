"""What packages compile against: the contract in C and Cython, and elementary functions for loops over slices."""
