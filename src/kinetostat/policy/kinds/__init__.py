"""What can be expected of a robot: one struct for each kind of table `[[robots.expect]]`."""
