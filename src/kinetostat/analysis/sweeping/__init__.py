"""Questions asked of millions of configurations: chunks, computed anywhere, added up exactly in any order."""
