"""Slabs that the page shows under a force that the reader moves: small k_T/k_N, and disorder."""
