"""Robot files: from bytes to a frozen description, safely."""
