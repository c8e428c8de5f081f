"""A first policy for a robot: what is true of it now, with some margin."""
