"""What changed between two versions of a robot, and what follows: matching -> structure -> consequences."""
