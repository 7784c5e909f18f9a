"""Pictures in one style: for the figures of the paper and for own results."""
