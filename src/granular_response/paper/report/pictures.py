"""The drawn figures, in the order of the paper, as pictures inside a page."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

#: Width of an embedded picture in pixels, and its number of colours: sharp on a phone, modest in size.
WIDTH, COLOURS = 1200, 128

#: Pixels of the page per pixel of a drawn picture, which has 200 to an inch: letters as large as the text.
SHOWN = 0.62

NUMBER_OF_FIGURES = 24

#: What each figure of the paper shows here.
CAPTIONS: dict[int, str] = {
    1: "Two theories of the pressure on the floor below a force. Elliptic: an elastic slab on a rough or a smooth "
    "floor, and a half plane at the same depth. Hyperbolic: two rays that spread diffusively, for two depths. "
    "Not in the paper: simulated responses to a force of 0.01 mg beside the elastic slab with their moduli and floor, "
    "and the largest distance of the two as the number of layers grows (8 wide: eight disks of a row for each layer; "
    "slow: gravity grows slowly). Two things keep packings from it: beside smooth walls gravity opens contacts, which "
    "is felt in a narrow slab of any depth, and a sudden fall on a rough floor can open a row in the middle, as with "
    "15 layers.",
    2: "Contact forces in a disordered packing, polydispersity 0.25: under gravity, and what a force on top adds. "
    "Marks on the disks show how far they have turned.",
    3: "Ordered slab without friction: floor response per applied force. One peak splits into two as the force grows.",
    4: "Contacts that the force opens in the same slab. They are horizontal, and their region grows downwards.",
    5: "Depth and largest width of that region against the force, for slabs of several depths, and what the stiffness "
    "of the disks changes.",
    6: "Response at x = 0 per applied force. It is constant in the linear range, which friction extends.",
    7: "Floor response at friction 0.2 and 1 for growing forces.",
    8: "Contacts opened and sliding at friction 0.2.",
    9: "Contacts opened and sliding at friction 1.",
    10: "Floor response at friction 10 for several ratios of tangential to normal stiffness: two peaks at small ones.",
    11: "The spring model: a triangular lattice with normal and tangential springs, horizontal and oblique ones apart.",
    12: "Floor response at one force for several coefficients of friction.",
    13: "What a force adds at the contacts of a slab, for three coefficients of friction; width by magnitude.",
    14: "The vertical stress of these forces, coarse-grained with a Gaussian, beside that of a harmonic lattice.",
    15: "Magnitude of the added contact forces against position at several depths under a large force.",
    16: "Large forces: a third peak at friction 0.2, and the loss of symmetry at friction 1.",
    17: "A pile under gravity without and with friction: contact forces, vertical stress, and contact network.",
    18: "Force chains under an oblique force on one disk, for several torques on the same disk and packing.",
    19: "Slightly disordered slabs without and with friction: single realizations thin, their mean thick. Above, "
    "the largest disks touch at the start, which gives the paper's peaks; below, the start is the lattice that its "
    "text names, of constant two mean radii.",
    20: "Response at x = 0 per applied force in one slightly disordered slab, for several coefficients of friction, "
    "beside the lattice, and where their linear ranges end (arrows: beyond the largest force).",
    21: "Mean floor response of 20 disordered slabs, with its standard error, for several polydispersities, "
    "coefficients of friction and forces. A number in brackets is that of the slabs at rest, where some collapsed.",
    22: "Crossover force from one peak to two against friction, for each polydispersity and two smoothing widths. "
    "Thick and thin bars hold 68 % and 95 % of the bootstrap draws over realizations; open triangles are bounds.",
    23: "Two loads of 0.2 mg on a slightly disordered slab: the response to both and the sum of the responses to each, "
    "disk by disk, for several distances d.",
    24: "The same with 1 mg. Then the difference of the two, root mean square relative to both: against the force, for "
    "the floor and for all contacts, and against depth. Means of the realizations with standard errors. Dotted: change "
    "of the contact forces per force under a single load, relative to the smallest. Shaded: where the linear range of "
    "the middle half of the realizations ends; broken line: its median.",
}

#: What further figures show, by stem.
FURTHER: dict[str, str] = {
    "five_realizations": "How often the mean response of five slabs has as many peaks as that of twenty, against the "
    "force over the crossover force; one line for each polydispersity and coefficient of friction.",
    "numerics": "What the paper says about its numerics: the error of floor forces against the kinetic energy at which "
    "a run stops, the kinetic energy of statically finished states put back into the dynamics, and the time to rest "
    "against the damping of a contact.",
    "packings": "Packings at rest: directions of their contacts without friction for both starts, contacts of a disk "
    "away from the boundaries (bars: standard deviation), and the part that does not collapse under a force (colours "
    "as before).",
    "sensitivity": "How much each reading of the paper changes the floor response; the table below has the numbers.",
    "stability_motion": "Undamped systems, energy change per kinetic energy at first: a kicked slab without "
    "friction, with a twentieth of the largest stable time step, and the same with friction 0.2, which only takes "
    "energy. Collisions without dashpots, largest of all spins and coefficients of friction: the default rule of "
    "friction never gives energy, the paper's equation for the spring taken literally does. Disks set on the floor "
    "with a velocity and a spin, which slide until they roll: lines simulated, symbols in closed form.",
    "stability_scenes": "What became of random scenes: blue have a result, orange an error of one line, and wrong "
    "would be a result that its positions contradict or an error that nobody understands. The largest unbalanced "
    "force of certified results, computed from positions alone (broken line: 1e-9; beyond are stiff scenes, where "
    "the last digit of a position is worth that much). Relative change of a floor response when the rest state is "
    "displaced by 1e-12 of a radius (broken line).",
    "stability_steps": "What becomes of a kicked slab at rest in raw dynamics, for time steps in units of the "
    "predicted limit. One property of the scene is changed in each column.",
}

_NUMBER = re.compile(r"fig(\d+)")


@dataclass(frozen=True)
class Picture:
    """A picture and the module that draws it."""

    stem: str
    group: str
    source: str  #: data URI
    width: int
    height: int
    shown: int  #: width on a wide screen in pixels of the page

    @property
    def module(self) -> str:
        return f"src/granular_response/figures/{self.group}.py"

    @property
    def number(self) -> int | None:
        """Number of the paper's figure that it belongs to."""
        match = _NUMBER.match(self.stem)
        return int(match[1]) if match and int(match[1]) in CAPTIONS else None

    @property
    def title(self) -> str:
        return self.stem.replace("_", " ").capitalize()

    @property
    def caption(self) -> str:
        """Of a further figure."""
        return FURTHER.get(self.stem, "")


@dataclass(frozen=True)
class Figure:
    """A figure of the paper with its pictures, none if it is not drawn yet."""

    number: int
    caption: str
    pictures: tuple[Picture, ...]


@dataclass(frozen=True)
class Pictures:
    """The figures of the paper, and what else is drawn."""

    numbered: tuple[Figure, ...]
    further: tuple[Picture, ...]

    def all(self) -> Iterator[Picture]:
        for figure in self.numbered:
            yield from figure.pictures
        yield from self.further


def collect(folder: Path) -> Pictures:
    """All pictures ``folder/GROUP/STEM.png``; a stem that begins with ``figNN`` belongs to that figure."""
    numbered: dict[int, list[Picture]] = {number: [] for number in range(1, NUMBER_OF_FIGURES + 1)}
    further = []
    for path in sorted(folder.glob("*/*.png"), key=lambda path: (path.stem, path.parent.name)):
        picture = embed(path)
        if picture.number is None:
            further.append(picture)
        else:
            numbered[picture.number].append(picture)
    figures = tuple(Figure(n, CAPTIONS[n], tuple(found)) for n, found in numbered.items())
    return Pictures(figures, tuple(further))


def embed(path: Path) -> Picture:
    """A drawn picture as a data URI, not wider than WIDTH and with few colours."""
    with Image.open(path) as image:
        plain = image.convert("RGB")
    shown = round(SHOWN * plain.width)
    if plain.width > WIDTH:
        plain = plain.resize((WIDTH, round(plain.height * WIDTH / plain.width)), Image.Resampling.LANCZOS)
    small = plain.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    buffer = io.BytesIO()
    small.save(buffer, format="PNG", optimize=True)
    source = "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode()
    return Picture(path.stem, path.parent.name, source, small.width, small.height, shown)
