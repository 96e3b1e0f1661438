"""Contact of coils: the law of a pair, its kinematics, its history, and what is read of it."""
