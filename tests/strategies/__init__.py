"""Strategies of hypothesis for what stands in a scene: small, of few types, with extremes in every number."""
