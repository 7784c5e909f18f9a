"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    6: "Response at x = 0 per applied force. It is constant in the linear range, which friction extends.",
    7: "Floor response at friction 0.2 and 1 for growing forces.",
    8: "Contacts opened and sliding at friction 0.2.",
    9: "Contacts opened and sliding at friction 1.",
    12: "Floor response at one force for several coefficients of friction.",
    16: "Large forces: a third peak at friction 0.2, and the loss of symmetry at friction 1.",
}
