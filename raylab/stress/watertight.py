"""Closed bodies that let no ray out; hits on very wide boxes."""
