"""Packings from CSV files: what is read, and the error for what cannot be."""

import numpy as np
import pytest
from stress.random_scenes import write_table

from granular_response.scene import FilePacking, Scene, SceneError, SlabPacking


@pytest.fixture
def build(tmp_path):
    def build(text, width=10.0):
        path = tmp_path / "disks.csv"
        path.write_text(text)
        return FilePacking(path=str(path), width=width).build()

    return build


def test_reads_and_rescales(build):
    packing = build("x,z,radius\n5,5,3\n15,5,5\n10,12,7\n", width=20.0)
    assert np.allclose(packing.position, [[1.0, 1.0], [3.0, 1.0], [2.0, 2.4]])
    assert np.allclose(packing.radius, [0.6, 1.0, 1.4])
    assert packing.width == 4.0
    assert packing.left is None and packing.neighbour_pairs() is None
    assert packing.n == 3 and list(packing.row) == [-1, -1, -1]
    assert packing.position.flags.c_contiguous
    assert packing.mass.mean() == pytest.approx(1.0)
    assert len(packing.row_count) == 0


def test_a_lattice_from_a_file_is_the_lattice(build):
    slab = SlabPacking(layers=3, disks_per_row=5, polydispersity=0.3).build()
    table = 3.75 * np.column_stack([slab.position, slab.radius])
    rows = [",".join(f"{value:.17g}" for value in row) for row in table]
    packing = build("x,z,radius\n" + "\n".join(rows), width=3.75 * slab.width)
    assert np.allclose(packing.position, slab.position, rtol=1e-14)
    assert np.allclose(packing.radius, slab.radius, rtol=1e-14)
    assert packing.width == pytest.approx(slab.width)


def test_layout_of_the_file(build):
    text = "\ufeff# lengths in mm\n\nid, radius ,z,x\n a, 1.0, 2.0, 3.0\n\n# the second\nb,1,2,5e0\n,,,\n"
    packing = build(text)
    assert np.allclose(packing.position, [[3.0, 2.0], [5.0, 2.0]])


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("x,z,radius\n", "has no disks, must have a header x,z,radius and a line for each disk"),
        (
            "x,z\n1,1\n",
            "column radius is missing, header must name x, z and radius; there are x, z; packing.columns says which "
            "are meant, as {z: Y, radius: R}",
        ),
        (
            "id,X,height,size\n1,1,1,1\n",
            "columns z and radius are missing, header must name x, z and radius; there are id, X, height, size; "
            "packing.columns says which are meant, as {z: Y, radius: R}",
        ),
        ("x,z,radius,x\n", "column x is given 2 times, header must name x, z and radius"),
        ("x,z,radius\n1,1,1\n3,1\n", "line 3: has 2 values, must have 3 as the header"),
        ("x,z,radius\n\n1,one,1\n", "line 3: z = 'one': must be a finite number"),
        ("x,z,radius\n1,1,1\nnan,1,1\n", "line 3: x = 'nan': must be a finite number"),
        ("x,z,radius\n1,1,1\n3,1,0\n", "line 3: radius = 0.0: must be greater than 0"),
        (
            "x,z,radius\n1,1,1\n10,1,1\n",
            "line 3: x = 10.0: must be between the side walls 0 and 10; the disks reach from 0 to 11, "
            "packing.origin says where left wall and floor are",
        ),
        ("x,z,radius\n1,1,1\n5,6,5.1\n", "line 3: radius = 5.1: must be at most 5, half the width of the box"),
        ("x,z,radius\n1,-1,1\n", "line 2: z = -1.0: must be above the floor 0, which packing.origin says"),
        ("x,z,radius\n1,1,1\n3,1,1\n1,1,2\n", "line 4: disk is in the same place as that of line 2"),
    ],
)
def test_mistakes_name_the_line(build, tmp_path, text, rule):
    with pytest.raises(SceneError) as caught:
        build(text)
    path, _, rest = str(caught.value).removeprefix("packing.path = ").partition(": ")
    assert rest == rule
    assert len(str(caught.value).splitlines()) == 1
    assert path.startswith("'") and path.endswith("'")


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(SceneError, match=r"^packing\.path = 'nowhere\.csv': no such file$"):
        FilePacking(path="nowhere.csv", width=1.0).build()
    with pytest.raises(SceneError, match="cannot be read: "):
        FilePacking(path=str(tmp_path), width=1.0).build()
    (tmp_path / "a").write_bytes(b"x,z,radius\n\xff,1,1")
    with pytest.raises(SceneError, match=r"is not a text file in UTF-8$"):
        FilePacking(path=str(tmp_path / "a"), width=1.0).build()


def test_a_packing_in_two_scenes_is_read_where_each_is(tmp_path):
    for folder, count in (("a", 2), ("b", 3)):
        (tmp_path / folder).mkdir()
        write_table(tmp_path / folder / "disks.csv", np.array([(2 * k + 1, 1, 1) for k in range(count)], float))
    shared = Scene.from_dict({"packing": {"kind": "file", "path": "disks.csv", "width": 10.0}, "loads": []}).packing
    scenes = [Scene.from_dict({"packing": shared, "loads": []}, folder=tmp_path / folder) for folder in "ab"]
    assert [scene.packing.build().n for scene in scenes] == [2, 3]
    assert shared.folder is None
