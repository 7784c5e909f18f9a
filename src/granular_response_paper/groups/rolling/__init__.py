"""What rolling resistance changes: piles on a flat floor without support, the response of a slab, couple stresses."""
