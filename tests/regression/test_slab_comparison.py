"""Small forces on small slabs beside the elastic slab, from parameters through a file to the figure."""


def test_deeper_slabs_are_nearer_to_the_elastic_one(datasets) -> None:
    slabs = datasets["slabs"]
    distance = slabs["distance"].values
    for first, last in ((0, 2), (3, 4), (5, 6)):
        assert distance[last] < 0.5 * distance[first] < 0.03
    # the right floor is told from the wrong one
    assert (distance < 0.4 * slabs["distance_other_floor"].values).all()
