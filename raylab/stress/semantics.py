"""What Python and numba make of NaN, of zero and of overflow."""
