"""``coilcheck study-law``: what the project can say about a law of a half coil that a user wrote."""
