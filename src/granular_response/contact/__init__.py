"""Contact laws: the force of one contact from its overlap and motion (Sec. III.A)."""
