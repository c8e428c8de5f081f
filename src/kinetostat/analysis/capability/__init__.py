"""Maps of voxels: where a tool gets, how well it moves there, from which directions it comes; where to place a base."""
