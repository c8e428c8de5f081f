"""Results to text, JSON and CSV. Nothing is computed and nothing is printed here."""
