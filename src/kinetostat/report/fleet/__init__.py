"""The report over many robots: what is in it, how it is computed robot by robot, and its four files."""
