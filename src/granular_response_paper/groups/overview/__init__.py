"""The paper in one picture, and in one animation: slabs under a small and a large force, with and without friction."""
