"""What the public namespace of the package stands on: results as one object."""
