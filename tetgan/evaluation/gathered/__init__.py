"""Tables across categories, gathered from what other stages measured."""
