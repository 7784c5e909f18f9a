"""Claims P1 to P4: a pile under gravity (Sec. V.F)."""

from __future__ import annotations

from ...claims.bounds import at_least, at_most, higher_by, same_size
from ...claims.claim import Ask, Claims, Data, Numbers

GROUP = "pile_dip"
claim = Claims(
    GROUP, {"scene.packing.layers": 11, "scene.contact.friction": 0.94, "scene.wall.friction": 0.35,
            "scene.contact.stiffness_ratio": 0.5, "scene.preparation.gravity": "at-once"}
)  # fmt: skip


@claim("P1", "V.F, Fig. 17c, d",
       Ask("dip of the vertical stress under the apex per largest value", at_least("visible"), "%"),
       Ask("the same with friction", at_most("visible"), "%"), figures=[17])  # fmt: skip
def dip(data: Data) -> Numbers:
    """In particular, as shown in Figs. 17(c),(d), the pile of frictionless disks exhibits a dip in the stress under the
    apex, but the pile of frictional disks does not.
    Short: Piles have a dip without friction, and none with friction
    Here: Without friction the stress dips by {0} under the apex. With friction it is largest there."""
    yield tuple(data.value(GROUP, "stress.dip", case=case) for case in ("frictionless", "frictional"))


@claim("P3", "V.F, Fig. 17e, f", Ask("size with friction per without", same_size("similar")),
       Ask("width per height, one pile over the other", higher_by("nearly")), primary="contacts",
       figures=[17])  # fmt: skip
def regions(data: Data) -> Numbers:
    """In the frictional case, the size of the region of open contacts in the central region of the pile is quite
    similar, but its shape is different [Figs. 17(e),(f)].
    Short: The open region has a similar size but another shape with friction
    Here: With friction the open region has {0} times the contacts, and its ratio of width to height differs by a factor
    of {1}."""
    study = data.get(GROUP, "piles")
    full, without = (study.sel(case=case, drop=True) for case in ("frictional", "frictionless"))
    contacts, height, width = (float((full / without)[f"central_{n}"]) for n in ("open_contacts", "height", "width"))
    for name, size in (("contacts", contacts), ("height", height), ("width", width)):
        yield name, size, max(width / height, height / width)


@claim("P4", "V.F, Fig. 17e", Ask("dip of the floor force with one-sided contacts", at_least("visible"), "%"),
       Ask("dip with contacts that cannot open", at_most("visible"), "%"), figures=[17])  # fmt: skip
def open_contacts(data: Data) -> Numbers:
    """The dip in the frictionless case is due to the open horizontal contacts in the central region of the pile; see
    Fig. 17(e).
    Short: The dip is due to the open horizontal contacts
    Here: Without friction the floor force under the apex dips by {0}. If contacts cannot open, it is largest there.
    Remark: Glued contacts are two-sided springs between all neighbours of the lattice"""
    yield data.value(GROUP, "piles.floor_dip", case="frictionless"), data.value(GROUP, "glued.floor_dip")
