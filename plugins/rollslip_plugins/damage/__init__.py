"""What slip does to surfaces: power and energy of sliding, film parameter, and temperatures in the contact."""
