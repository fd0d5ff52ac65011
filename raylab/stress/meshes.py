"""What is refused, dropped or warned about when a mesh is loaded."""
