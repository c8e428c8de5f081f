"""Inverse kinematics: poses, textbook iterations, a robust solver, all solutions."""
