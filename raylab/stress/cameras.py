"""Camera, lens and time at their limits."""
