"""Pictures of Whirl's results: one module per kind of picture, each with draw(study) -> [files]."""
