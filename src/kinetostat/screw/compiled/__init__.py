"""The compiled form of chains and trees of screws: kernels over lanes of configurations. The only place for numba."""
