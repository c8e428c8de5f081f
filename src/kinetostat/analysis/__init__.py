"""Answers: an engine and arrays in, frozen results with their certificates out."""
