"""The two engines that compute every number, and the protocol that both keep."""
