"""What is in the world: transforms, cameras, lights, models, visibility."""
