"""The gate: paths -> robots -> rules, readers' agreement, policy, each robot in a process of its own -> one result."""
