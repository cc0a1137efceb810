"""Another model's samples with fewer faces."""
