"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    "explorer": "Not in the paper: response at x = 0 of the slabs of the explorer that no other figure shows. Ordered "
    "slabs with a small k_T/k_N, and single disordered slabs, smoothed with w = 3 mean radii, up to the last force "
    "before they collapse.",
}
