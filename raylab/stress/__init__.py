"""Stiff and extreme: where ray tracers break, what raylab makes of it, and what the usual code does."""
