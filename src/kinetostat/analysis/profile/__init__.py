"""A robot as a whole, limb by limb: what a report tells of it."""
