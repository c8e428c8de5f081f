"""Singular configurations: whether, why, what is lost, how far, and where all of them are."""
