"""From a decoded field to a triangle surface and a solid tetrahedral mesh."""
