"""Screw theory on arrays: pure mathematics, no robot and no file."""
