"""The page: what it says agrees with the stored table, it needs no network, and a real browser shows all of it."""

import base64
import copy
import dataclasses
import io
import itertools
import json
import re
import shutil
import zlib
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from chromium import BROWSER, Chromium
from PIL import Image, ImageSequence
from places import ROOT
from xarray import Dataset

from granular_response.store import files as store
from granular_response.store.variables import variable
from granular_response_paper import report
from granular_response_paper.claims import table as claims
from granular_response_paper.claims.claim import Data
from granular_response_paper.claims.stored import ClaimsError
from granular_response_paper.claims.verdict import MEANINGS
from granular_response_paper.groups.sensitivity import simulate as sensitivity
from granular_response_paper.registry import PAPER, collections
from granular_response_paper.report import against, benchmarks, explorer, pictures, readings
from granular_response_paper.report.typeset import typeset

FORCES = (0.0, 1.0, 4.0, 90.0)


def states(friction):
    """Two rows of disks, seven below six. The force adds to the upright contacts and opens one of the others."""
    row, upper = np.arange(-6.0, 7.0, 2.0), np.arange(-5.0, 6.0, 2.0)
    place = np.concatenate(
        [np.stack([row, np.ones(7)], axis=1), np.stack([upper, np.full(6, 1.0 + 3**0.5)], axis=1)]
    ) + np.array([61.0, 0.0])
    pairs = [(i, j) for i in range(13) for j in range(i) if np.linalg.norm(place[i] - place[j]) < 2.01]
    first, second = np.array(pairs).T
    opened = (np.abs(place[first, 1] - place[second, 1]) < 0.1) & (np.arange(len(first)) % 5 == 0)
    normal = np.stack([np.full(len(first), 0.5 + force) for force in FORCES])
    status = np.stack([np.where(opened & (force > 2.0), 0, 1) for force in FORCES])
    return Dataset(
        {
            "position": variable(("state", "disk", "axis"), np.stack([place] * len(FORCES)), "position"),
            "contact_disk": variable(("contact",), first, "disk"),
            "contact_partner": variable(("contact",), second, "other disk"),
            "contact_status": variable(("state", "contact"), status, "status"),
            "contact_normal_force": variable(("state", "contact"), np.where(status == 0, 0.0, normal), "force"),
            "contact_tangential_force": variable(("state", "contact"), friction * normal, "force"),
            "force": variable(("state",), np.array(FORCES), "applied force"),
            "loaded_disk": variable((), 10, "loaded disk"),
        }
    )


def friction_study():
    x = np.arange(-6.0, 7.0, 2.0)
    dims = ("friction", "force")
    response = Dataset(
        {
            "floor_response": variable((*dims, "floor_disk"), np.full((3, 3, 7), 1.0 / 7.0), "response"),
            "peak_count": variable(dims, np.full((3, 3), 2.0), "peaks"),
            "response_at_centre": variable(dims, np.full((3, 3), 1.0 / 7.0), "response at x = 0"),
        },
        {
            "friction": variable(("friction",), np.array([0.0, 0.2, 1.0]), "friction"),
            "force": variable(("force",), np.array(FORCES[1:]), "force"),
            "x": variable(("floor_disk",), x, "place"),
        },
    )
    found = {"response": response, **{f"states_mu_{mu:g}": states(mu) for mu in (0.0, 0.2, 1.0)}}
    for dataset in found.values():
        dataset.attrs["scene"] = "contact: {stiffness_ratio: 0.8}\nwall: {friction: 0.0}\n"
    return found


def sensitivity_study():
    return Dataset(
        {
            "largest_difference": variable(("variant",), np.array([0.0, 8e-6]), "difference"),
            "text": variable(("variant",), ["as it is", "time step <halved>"], "what is changed"),
        },
        {"variant": variable(("variant",), ["reference", "of_its_own"], "name")},
    )


def readings_study(differences, **more):
    """A sensitivity study with a step for each reading, in another order than the table's."""
    names = ["reference", *reversed(list(readings.READINGS))]
    columns = {"largest_difference": np.array([0.0, *differences]), **more}
    return Dataset(
        {name: variable(("variant",), values, name) for name, values in columns.items()}
        | {"text": variable(("variant",), [f"words of {name}" for name in names], "what is changed")},
        {"variant": variable(("variant",), names, "name")},
    )


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A folder as the pipeline leaves it, with some of the figures."""
    folder = tmp_path_factory.mktemp("project")
    for name, size in {
        "theory/fig01_predictions": (1400, 500),
        "friction_linear_range/fig06_linear_range": (680, 520),
        "pile_dip/fig17_pile": (1400, 900),
        "pile_dip/fig17_pile_profiles": (700, 300),
        "numerics/numerics": (1400, 500),
    }.items():
        path = folder / "figures" / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        shade = np.linspace(0, 255, size[0] * size[1] * 3).reshape(size[1], size[0], 3).astype(np.uint8)
        Image.fromarray(shade).save(path)
        beside = path.with_name("captions.json")
        said = json.loads(beside.read_text()) if beside.exists() else {}
        said[path.stem] = {"caption": f"What {path.stem} <shows>.", "alternative": "How it looks.", "question": "Why?"}
        beside.write_text(json.dumps(said))
    store.write(folder / "data" / "friction_linear_range.nc", friction_study())
    store.write(folder / "data" / "phase_diagram.nc", {"crossovers": crossovers()})
    store.write(folder / "data" / "sensitivity.nc", {"mu_0.2": sensitivity_study()})
    (folder / "benchmarks").mkdir()
    goal = {"what": "Speed of a step", "goal": "at least 4", "measured": "5", "met": True}
    (folder / "benchmarks" / "summary.json").write_text(json.dumps({"goals": [goal]}))
    (folder / "requirements.lock").write_text("# pinned\nnumpy==2.9.1\nsome-other==1.0\n")
    data = Data({"friction_linear_range": friction_study()})
    judged = claims.document(claims.evaluate(data, claims.claims_in(PAPER)))
    (folder / "figures" / "claims.json").write_text(json.dumps(judged))
    return folder


@pytest.fixture(scope="module")
def page(root):
    return report.page(root)


@pytest.fixture(scope="module")
def judged(root):
    """The stored table of claims."""
    return json.loads((root / "figures" / "claims.json").read_text())


class Elements(HTMLParser):
    """Start tags of a page with their attributes."""

    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))

    def named(self, tag):
        return [attributes for name, attributes in self.found if name == tag]


def test_one_row_for_every_claim_with_its_verdict(judged, page):
    elements = Elements(page)
    rows = [row["id"] for row in elements.named("tr") if row.get("class", "").startswith("claim ")]
    assert rows == [f"claim-{row['id']}" for row in judged["table"]]
    chips = [span["class"] for span in elements.named("span") if span.get("class", "").startswith("chip")]
    assert chips == [f"chip {row['verdict'].replace(' ', '_')}" for row in judged["table"]]
    for part in ("ordered", "disorder"):
        tiles = page.partition(f'id="tiles-{part}"')[2].partition("<p ")[0]
        counted = re.findall(r'<a class="tile (\w+)" href="#only-\w+"><b>(\d+)</b>', tiles)
        found = {verdict: int(number) for verdict, number in counted}
        assert found == {verdict: number for verdict, number in judged["counts"][part].items() if number}
    for sentence in judged["scheme"]:
        assert f"<li>{sentence}</li>" in page


def test_a_row_has_its_quote_and_what_was_found(judged, page):
    """With whose sentence it is, the star of a threshold and the second column."""
    for row in judged["table"]:
        part = page.partition(f'<tr id="claim-{row["id"]}"')[2].partition("</tr>")[0]
        assert ("not the paper; " in part) == (row["source"] != "paper")
        assert ("is halved or doubled" in part) == bool(row["star"])
        assert ('class="elsewhere"' in part) == (row["elsewhere"] != "not tried")
        listed = report.telling(row["tests"])
        assert part.count("<li>") == len(listed) == min(len(row["tests"]), report.LISTED)
        assert ("more in <code>" in part) == (len(listed) < len(row["tests"]))


def test_of_many_tests_the_page_lists_those_that_do_not_hold():
    outcomes = ["yes"] * 5 + ["cannot tell"] * 4 + ["no"] * 3
    tests = [{"outcome": outcome, "place": place} for place, outcome in enumerate(outcomes)]
    assert [test["place"] for test in report.telling(tests)] == [0, 9, 10]
    assert report.telling(tests[:3]) == tests[:3]


def test_a_self_contained_page_needs_no_network_and_no_other_file(root):
    page = report.page(root, embedded=True)
    elements = Elements(page)
    assert all(image["src"].startswith("data:image/webp;base64,") for image in elements.named("img"))
    assert [link["href"] for link in elements.named("link")] == ["data:,"]
    assert not [script for script in elements.named("script") if "src" in script]
    assert not re.search(r"(?:https?:)?//[\w.]+\.\w+/", re.sub(r"base64,[\w+/=]+", "", page))
    assert "url(" not in page and "@import" not in page


def test_the_page_shows_the_pictures_beside_it(root, page):
    shown = [image["src"] for image in Elements(page).named("img") if not image["src"].startswith("data:")]
    assert shown and all((root / "figures" / source).exists() for source in shown)
    assert len(page) < len(report.page(root, embedded=True))


def test_every_figure_of_the_paper_has_a_place_and_others_stand_by_their_questions(page):
    assert sorted(map(int, re.findall(r' id="figure-(\d+)"', page))) == list(range(1, 25))
    assert page.count("not drawn yet") == 24 - 3
    assert page.count('<figure id="picture-') == 5
    assert page.count("<img ") == 5 + 3  # in full, and the paper's in small
    assert re.findall(r"<h3>([^<]+\?)</h3>", page) == ["Why?"]
    assert page.index('id="picture-fig17_pile"') < page.index("Why?") < page.index('id="picture-numerics"')
    assert "<b>Numerics. What numerics &lt;shows&gt;.</b>" in page
    targets = set(re.findall(r'href="#([\w-]+)"', page))
    assert targets <= {e["id"] for _, e in Elements(page).found if "id" in e}


def test_pictures_lead_to_the_files_that_are_there(root, page, tmp_path):
    part = page.partition('<figure id="picture-fig06_linear_range"')[2].partition("</figure>")[0]
    found = {name: link for link, name in re.findall(r'<a href="([^#"]+)">([\w ]+)</a>', part)}
    assert found["picture"] == "friction_linear_range/fig06_linear_range.png"
    assert found["data"] == "../data/friction_linear_range.nc"
    assert {"drawing", "simulation"} < set(found)
    assert all((root / "figures" / link).exists() for link in found.values())
    elsewhere = report.write(tmp_path / "elsewhere" / "page.html", root).read_text()
    moved = [a["href"] for a in Elements(elsewhere).named("a") if not a["href"].startswith("#")]
    assert moved and all((tmp_path / "elsewhere" / link).exists() for link in moved)


def test_claims_and_figures_lead_to_each_other(judged, page):
    def listed(mark, end="</figure>"):
        return page.partition(mark)[2].partition(end)[0]

    for row in judged["table"]:
        part = listed(f'<tr id="claim-{row["id"]}"', "</tr>")
        assert [int(number) for number in re.findall(r'href="#figure-(\d+)"', part)] == row["figures"]
    for number in (1, 6, 17):
        shown = re.findall(r'<li><a class="mark \w+" href="#claim-(\w+)">', listed(f'<span id="figure-{number}"'))
        assert shown == [row["id"] for row in judged["table"] if number in row["figures"]]
    # a further picture shows the claims of its group that no figure shows
    expected = [row["id"] for row in judged["table"] if row["group"] == "numerics" and not row["figures"]]
    found = re.findall(r'<li><a class="mark \w+" href="#claim-(\w+)">', listed('<figure id="picture-numerics"'))
    assert found == expected != []


def test_the_summary_names_what_is_not_supported(judged, tmp_path):
    whole = copy.deepcopy(judged)
    own = [row for row in whole["table"] if row["part"] != "extension"]
    own[1]["verdict"] = own[4]["verdict"] = "not supported"
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "claims.json").write_text(json.dumps(whole))
    part = report.page(tmp_path).partition('<ul id="failing">')[2].partition("</ul>")[0]
    expected = [row["id"] for row in own if row["verdict"] == "not supported"]
    assert re.findall(r'href="#claim-(\w+)"', part) == expected and len(expected) >= 2


def test_every_part_can_be_run_again(root, judged, page):
    rows = re.findall(r"<tr><td>([\w ]+)</td><td[^>]*>([\d, –]+)</td><td[^>]*><code>dvc repro draw@(\w+)</code>", page)
    drawn = {path.name for path in (root / "figures").iterdir() if path.is_dir()}
    assert {group for _, _, group in rows} == drawn | {row["group"] for row in judged["table"]}
    assert {group: figures for _, figures, group in rows}["pile_dip"] == "17"
    assert {group: figures for _, figures, group in rows}["numerics"] == "–"
    assert "numpy&nbsp;2.9.1" in page and "some-other" not in page


def test_texts_from_data_cannot_become_markup(page):
    assert "time step &lt;halved&gt;" in page and "<halved>" not in page


def test_readings_stand_in_their_own_order_with_a_column_for_each_slab():
    count = len(readings.READINGS)
    small = readings_study(np.arange(1, count + 1) * 1e-3)
    large = readings_study(np.arange(1, count + 1) * 1e-12).isel(variant=slice(0, -1))
    found = readings.table({"mu_0.2": small, "mu_1": large, "another": Dataset()})
    assert found.slabs == ("µ = 0.2", "µ = 1")
    assert [reading for reading, _ in found.rows] == list(readings.READINGS.values())
    assert found.rows[0][1] == (f"{count * 1e-3:.1e}".replace("e-0", "e-"), "")
    assert found.rows[-1][1] == ("1.0e-3", "1.0e-12")


def test_a_variant_without_words_is_shown_with_those_of_the_study():
    ((reading, differences),) = readings.table({"mu_0.2": sensitivity_study()}).rows
    assert reading.question == "time step <halved>" and differences == ("8.0e-6",)


def test_the_fragment_of_readings_is_the_same_every_time(tmp_path):
    count = len(readings.READINGS)
    study = readings_study(np.arange(1, count + 1) * 1e-3, response_sum=np.linspace(1.0, 0.9, count + 1))
    store.write(tmp_path / "data" / "sensitivity.nc", {"mu_0.2": study})
    text = report.fragments(tmp_path)["readings.md"]()
    assert text.startswith("| interpretation | choice |")
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert len(rows) == count + 2 and {row.count("|") for row in rows} == {5}
    largest = f"{count * 1e-3:.1e}".replace("e-0", "e-")
    assert f"| gravity | instantaneous | grows over 100 sqrt(R/g) | {largest} |" in rows
    place = 1 + list(reversed(list(readings.READINGS))).index("stop_1e-9")
    assert f"stopped at 1e-9 per disk: {study['response_sum'].values[place]:.4f} (µ = 0.2)" in text
    assert "as printed:" not in text  # its kinetic energy is not stored here
    assert report.fragments(tmp_path)["readings.md"]() == text


@pytest.mark.parametrize("collection", collections(), ids=lambda one: one.name)
def test_the_fragments_of_the_documents_hold_what_is_stored(collection):
    root = ROOT / collection.folder
    if missing := [g for g in report.datasets_read(collection) if not (root / "data" / f"{g}.nc").exists()]:
        pytest.skip(f"not simulated yet: {', '.join(missing)}")
    for name, made in report.fragments(root, collection).items():
        assert (ROOT / "docs" / "_generated" / name).read_text() == f"{made()}\n", "make reproduce, make extensions"


def test_the_stored_page_shows_the_stored_benchmarks():
    stored = (ROOT / report.OUTPUT).read_text()
    shown = [one.picture for one in benchmarks.collect(ROOT / "benchmarks", ROOT / "figures")]
    assert len(shown) > 5
    assert [one.stem for one in shown if one.source not in stored] == [], "make reproduce"


def test_every_figure_with_parameters_stands_beside_its_caption():
    assert [row.figure for row in against.ROWS] == sorted(row.figure for row in against.ROWS)
    assert {row.figure for row in against.ROWS} == set(range(1, 25)) - {11}  # a drawing of springs
    assert {row.group for row in against.ROWS} <= set(PAPER.groups)


@pytest.mark.parametrize(
    ("paper", "remark", "said"),
    [
        ((1.0, 4.0), "", "| 3 | (a) | F_ext, mg: 1, 4 |"),
        ((4.0,), "as in Fig. 3", "| 3 | (a) | F_ext, mg | 4 | 1, 4, 90 | yes; as in Fig. 3 |"),
        ((5.0,), "a reason", "| 3 | (a) | F_ext, mg | 5 | 1, 4, 90 | no: a reason |"),
        ((), "on the plots only", "| 3 | (a) | F_ext, mg | – | 1, 4, 90 | on the plots only |"),
    ],
)
def test_a_parameter_is_the_papers_or_has_a_reason(tmp_path, monkeypatch, paper, remark, said):
    store.write(tmp_path / "theory.nc", {"one": friction_study()["response"]})
    row = against.Row(3, "(a)", "F_ext, mg", paper, "theory/one:force", remark)
    monkeypatch.setattr(against, "ROWS", (row,))
    assert [line for line in against.markdown(tmp_path).splitlines() if line.startswith("| 3")] == [said]


def test_another_parameter_without_a_reason_is_an_error(tmp_path, monkeypatch):
    store.write(tmp_path / "data" / "theory.nc", {"one": friction_study()["response"]})
    monkeypatch.setattr(against, "ROWS", (against.Row(3, "(a)", "F_ext", (5.0,), "theory/one:force"),))
    monkeypatch.setattr(readings, "markdown", lambda datasets: "")
    store.write(tmp_path / "data" / "sensitivity.nc", {})
    with pytest.raises(report.ReportError, match=r"figure 3, F_ext: 1, 4, 90 where the paper has 5, and nothing says"):
        report.write_fragments(tmp_path / "documents", tmp_path)


def test_parameters_are_read_from_variables_scenes_and_attributes():
    data = {"one": friction_study()["response"].assign_attrs(width=3.0)}
    found = [
        against.Row(1, "", "", (), f"theory/one{source}").stored(data).tolist()
        for source in (":friction", "@contact.stiffness_ratio", "@wall.friction", "#width")
    ]
    assert found == [[0.0, 0.2, 1.0], [0.8], [0.0], [3.0]]


def test_every_reading_of_the_table_is_a_variant_of_the_study():
    assert set(readings.READINGS) == set(sensitivity.VARIANTS) - {"reference"}


def test_the_same_files_give_the_same_bytes(root, tmp_path):
    first = report.write(tmp_path / "a.html", root)
    second = report.write(tmp_path / "b.html", root)
    assert first.read_bytes() == second.read_bytes()


def test_embedded_pictures_are_as_drawn(root):
    path = root / "figures" / "theory" / "fig01_predictions.png"
    picture = pictures.shown(path, root / "figures", embedded=True)
    assert (picture.width, picture.height, picture.shown, picture.plot) == (1400, 500, 868, False)
    with Image.open(io.BytesIO(base64.b64decode(picture.source.partition(",")[2]))) as shown, Image.open(path) as drawn:
        assert shown.format == "WEBP"
        difference = np.abs(np.asarray(shown).astype(int) - np.asarray(drawn))
        assert difference.shape == (500, 1400, 3) and difference.max() <= 16 and np.mean(difference) < 4


def test_every_picture_has_an_alternative_text_of_its_own(page):
    texts = [
        image["alt"] for image in Elements(page).named("img") if image["alt"]
    ]  # the small ones are links with words
    assert len(set(texts)) == len(texts) == 5
    assert [text.partition(":")[0] for text in texts if text.startswith("Fig. 17")] == [
        "Fig. 17, pile",
        "Fig. 17, pile profiles",
    ]


def test_captions_that_are_none_are_one_line(root, tmp_path):
    shutil.copytree(root, tmp_path / "copy")
    (tmp_path / "copy" / "figures" / "theory" / "captions.json").write_text("[]")
    with pytest.raises(report.ReportError, match=r"theory/captions.json: holds no captions") as caught:
        report.page(tmp_path / "copy")
    assert "\n" not in str(caught.value)


def test_the_overview_stands_at_the_top_and_moves(root, tmp_path):
    shutil.copytree(root, tmp_path / "copy")
    for name in ("overview/overview", "overview/growing_force"):
        path = tmp_path / "copy" / "figures" / f"{name}.png"
        path.parent.mkdir(exist_ok=True)
        Image.new("RGB", (1400, 500), "black").save(path)
    frames = [Image.new("P", (70, 30), colour) for colour in (0, 1)]
    for frame in frames:
        frame.putpalette([0, 0, 0, 255, 255, 255])
    moving = tmp_path / "copy" / "figures" / "overview" / "growing_force.gif"
    frames[0].save(moving, save_all=True, append_images=frames[1:], duration=[160, 1500])
    text = report.page(tmp_path / "copy")
    assert (
        'src="overview/growing_force.gif"' in text.partition('id="picture-growing_force"')[2].partition("</figure>")[0]
    )
    assert text.index('id="results"') < text.index('id="picture-overview"') < text.index('id="figures"')
    assert text.count('picture-overview"') == 1 and text.index('id="picture-growing_force"') > text.index(
        'id="figures"'
    )
    held = report.page(tmp_path / "copy", embedded=True).partition('id="picture-growing_force"')[2]
    source = re.search(r'src="data:image/webp;base64,([^"]*)"', held)
    with Image.open(io.BytesIO(base64.b64decode(source[1]))) as moving:
        assert [np.asarray(frame.convert("RGB")).mean() for frame in ImageSequence.Iterator(moving)] == [0.0, 255.0]


def test_the_message_is_the_first_sentence_of_a_caption(root):
    picture = pictures.shown(root / "figures" / "numerics" / "numerics.png", root / "figures")
    for said, parts in {
        "As in Fig. 6 it rises, w = 3. (a) Force. Rest.": ("As in Fig. 6 it rises, w = 3.", "(a) Force. Rest."),
        "Secs. V and VI, k_T/k_N = 0.2 alone": ("Secs. V and VI, k_T/k_N = 0.2 alone", ""),
    }.items():
        one = dataclasses.replace(picture, caption=said)
        assert (one.message, one.details) == parts


def test_results_come_first_and_the_table_of_claims_after_the_figures(page):
    names = ("results", "figures", "try", "claims", "words", "readings", "benchmarks", "rerun", "versions")
    places = [page.index(f' id="{name}"') for name in names]
    assert places == sorted(places)


def test_the_parts_of_the_table_stand_apart(judged, page):
    for part in ("ordered", "disorder"):
        body = page.partition(f'<tbody id="part-{part}">')[2].partition("</tbody>")[0]
        expected = [row["id"] for row in judged["table"] if row["part"] == part]
        assert re.findall(r'<tr id="claim-(\w+)"', body) == expected != []
    assert f'<label for="only-all">all <b>{len(judged["table"])}</b></label>' in page
    for kind in (key["verdict"] for key in judged["verdicts"]):
        count = sum(row["verdict"] == kind for row in judged["table"])
        assert f'<label for="only-{kind.replace(" ", "_")}">{kind} <b>{count}</b></label>' in page


def test_the_page_says_its_size(page):
    assert f"Beside its pictures this page has {len(page.encode()) / 1e6:.1f} MB" in page


def test_there_is_a_filter_for_every_kind_of_verdict(page):
    kinds = [row["id"] for row in Elements(page).named("input") if row.get("name") == "only"]
    assert kinds[0] == "only-all" and len(kinds) == 1 + len(MEANINGS)
    for kind in kinds[1:]:
        assert f"#{kind}:checked ~ table .claim:not(.{kind.removeprefix('only-')}, :target)" in page


@pytest.mark.parametrize(
    ("plain", "typed"),
    [
        ("-2.6 % at -.5, (-3)", "\u22122.6 % at \u2212.5, (\u22123)"),
        ("0.5-0.7 and A-1", "0.5-0.7 and A-1"),
        ("1.2e-12 or 1e-13", "1.2\u202f×\u202f10<sup>\u221212</sup> or 10<sup>\u221213</sup>"),
        ("sigma_zz, k_T/k_N", "<i>σ</i><sub>zz</sub>, <i>k</i><sub>T</sub>/<i>k</i><sub>N</sub>"),
        ("R^2 and R^-1", "R<sup>2</sup> and R<sup>\u22121</sup>"),
        ("sqrt(k), sqrt(R/g)", "√k, √(R/g)"),
        ("stop_1e-9, fig_01.png, mu_0.2, floor_disk", "stop_1e-9, fig_01.png, mu_0.2, floor_disk"),
        ("µ_wall = 0, F_ext", "<i>µ</i><sub>wall</sub> = 0, <i>F</i><sub>ext</sub>"),
        ("<b> & c", "&lt;b&gt; &amp; c"),
    ],
)
def test_texts_are_set_with_minus_signs_powers_and_subscripts(plain, typed):
    assert typeset(plain) == typed


def crossovers():
    case = ("case",)
    return Dataset(
        {
            "force": variable(("width", "case"), [[3.0, 20.0, 5.0, 9.0]], "force"),
            "kind": variable(("width", "case"), [[0, 2, 1, 0]], "kind"),
            "interval": variable(
                ("width", "case", "level"), [[[3.0, 3.0], [20.0, np.inf], [0.0, 6.0], [8.0, 9.5]]], "interval"
            ),
        },
        {
            "width": variable(("width",), [6.0], "width"),
            "polydispersity": variable(case, [0.0, 0.0, 0.25, 0.25], "spread"),
            "friction": variable(case, [1.0, 0.2, 0.2, 1.0], "friction"),
            "lattice_constant": variable(case, ["touching-largest"] * 3 + ["2.0"], "lattice"),
        },
    )


def unpacked(data):
    """Of each slab its ends of contacts, levels and sliding contacts, as the page's script takes them apart."""
    left = zlib.decompress(base64.b64decode(data["packed"]))
    found = []
    for slab in data["slabs"]:
        count, frames = slab["contacts"], len(slab["forces"])
        size = 8 * count + frames * (count + -(-count // 8))
        here, left = left[:size], left[size:]
        rows = np.frombuffer(here[8 * count :], np.uint8).reshape(frames, -1)
        levels, bits = rows[:, :count].view(np.int8), np.unpackbits(rows[:, count:], axis=1)[:, :count]
        found.append((np.frombuffer(here[: 8 * count], "<i2").reshape(count, 4), levels, bits.astype(bool)))
    assert not left
    return found


def test_explorer_data_are_those_of_the_states():
    data = explorer.payload(friction_study())
    assert [slab["friction"] for slab in data["slabs"]] == [0.0, 0.2, 1.0]
    assert all(slab["forces"] == [1.0, 4.0, 90.0] for slab in data["slabs"])  # at rest nothing is added
    smooth, _, rough = unpacked(data)
    opened = (smooth[1] == explorer.OPENED).sum(axis=1).tolist()
    assert opened == [0, *[int((states(0.0)["contact_status"].values[2] == 0).sum())] * 2] and opened[1] > 0
    # every closed contact gets as much as the applied force; tangential forces add as a vector
    strongest = np.sqrt(2.0) * 1.0
    assert data["strongest"] == pytest.approx(strongest, rel=1e-6)
    assert set(smooth[1][0]) == {round(explorer.FULL * np.sqrt(1.0 / strongest))}
    assert set(rough[1][0]) == {explorer.FULL}
    # at friction 1 the tangential forces are the normal ones, the Coulomb limit; without friction nothing slides
    assert rough[2][0].all() and not smooth[2].any()
    assert data["slabs"][0]["response"] == [[0.1429] * 7] * 3 and data["slabs"][0]["peaks"] == [2, 2, 2]
    assert data["slabs"][0]["about"] == "ordered packing, µ = 0, µ_wall = 0, k_N = 3000 mg/R"
    assert [one["friction"] for one in data["range"]] == [0.0, 0.2, 1.0]
    assert data["range"][0]["force"] == [1.0, 4.0]  # Fig. 6 ends at 50


def test_lost_compression_has_the_other_sign():
    study = friction_study()
    falling = study["states_mu_0"]
    falling["contact_normal_force"] = 0.5 + 1.0 - 0.01 * falling["force"] + 0.0 * falling["contact_normal_force"]
    _, levels, _ = unpacked(explorer.payload(study))[0]
    assert (levels[0] < 0).all()


def test_fig_22_stands_beside_the_slabs():
    data = explorer.payload(friction_study(), {"crossovers": crossovers()})
    assert [slab["friction"] for slab in data["slabs"]] == [0.0, 0.2, 1.0]
    assert data["slabs"][0]["peaks"] == [2, 2, 2] and [one["force"] for one in data["slabs"][1]["paper"]] == [
        4.0,
        20.0,
        40.0,
    ]
    assert data["crossovers"] == [
        {"polydispersity": 0.0, "friction": [0.2, 1.0], "force": [20.0, 3.0], "low": [20.0, 3.0],
         "high": [None, 3.0], "kind": [2, 0]},
        {"polydispersity": 0.25, "friction": [0.2], "force": [5.0], "low": [None], "high": [6.0], "kind": [1]},
    ]  # fmt: skip


def test_no_slider_without_states(root, tmp_path):
    bare = tmp_path / "bare"
    (bare / "figures").mkdir(parents=True)
    shutil.copy(root / "figures" / "claims.json", bare / "figures")
    text = report.page(bare)
    assert 'id="explorer"' not in text and 'type="range"' not in text
    assert text.count("not drawn yet") == 24 and text.count("Not measured yet") == 2


@pytest.mark.parametrize(("content", "problem"), [(None, "No such file"), ("{", "Expecting"), ("[]", "is not a")])
def test_a_missing_or_damaged_table_is_one_line(tmp_path, content, problem):
    if content is not None:
        (tmp_path / "figures").mkdir()
        (tmp_path / "figures" / "claims.json").write_text(content)
    with pytest.raises(ClaimsError, match=rf"claims\.json: {problem}") as caught:
        report.page(tmp_path)
    assert "\n" not in str(caught.value)


def test_a_table_that_lacks_a_part_is_one_line(judged, tmp_path):
    whole = judged
    (tmp_path / "figures").mkdir()
    row = whole["table"][0]
    partial = [{**whole, "table": [{k: v for k, v in row.items() if k != key}]} for key in ("group", "id")]
    partial += [{**whole, "table": 3}, {**whole, "verdicts": [{}]}, {**whole, "counts": {}}]
    for found in partial:
        (tmp_path / "figures" / "claims.json").write_text(json.dumps(found))
        with pytest.raises((ClaimsError, report.ReportError), match="is not a whole table of claims") as caught:
            report.page(tmp_path)
        assert "\n" not in str(caught.value)


def test_benchmarks_show_goals_and_pictures(root, tmp_path):
    row = report.page(root).partition("<td>Speed of a step</td>")[2].partition("</tr>")[0]
    assert re.findall(r">([^<>]+)</td>", row) == ["at least 4", "5", "yes"]
    (tmp_path / "figures").mkdir()
    Image.new("RGB", (400, 200), "white").save(tmp_path / "figures" / "kernel.png")
    (kernel,) = benchmarks.collect(tmp_path, tmp_path)
    assert (
        kernel.title == "Kernel" and kernel.picture.width == 400 and kernel.picture.text == f"Kernel: {kernel.caption}"
    )
    assert benchmarks.goals(tmp_path) == []


@pytest.fixture(scope="module")
def tab(tmp_path_factory):
    if BROWSER is None:
        pytest.skip("no Chromium or Chrome is installed (Debian: apt install chromium)")
    with Chromium(tmp_path_factory.mktemp("profile")) as browser:
        yield browser


@pytest.fixture(scope="module")
def opened(tab, root, tmp_path_factory):
    """Opens the page, with its explorer ready."""
    path = tmp_path_factory.mktemp("page") / "page.html"
    path.write_text(report.page(root, embedded=True))

    def show(width, **options):
        del tab.problems[:], tab.requests[:]
        tab.open(path, width, **options)
        if options.get("scripts", True):
            tab.wait("'ready' in document.getElementById('explorer').dataset")
        return tab

    return show


def force(tab):
    return tab.run("[document.getElementById('force').getAttribute('aria-valuetext'), said.textContent]")


def drawn(tab):
    return tab.run("['network', 'floor', 'range', 'phase'].map(id => document.getElementById(id).toDataURL())")


#: The tables that are wider than the column they stand in.
WIDER = (
    "Array.from(document.querySelectorAll('table')).filter(t => t.offsetWidth > t.parentElement.clientWidth + 1)"
    ".map(t => t.innerText.slice(0, 40))"
)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1400, 1920])
def test_a_browser_shows_all_of_it(judged, opened, width, scheme):
    tab = opened(width, scheme=scheme)
    assert tab.problems == [] and {Path(url).name for url in tab.requests} == {"page.html"}
    assert tab.run("document.querySelectorAll('tr.claim').length") == len(judged["table"])
    assert tab.run("document.documentElement.scrollWidth") == tab.run("document.documentElement.clientWidth") == width
    sizes = "i => [i.naturalWidth, i.clientWidth, i.parentElement.clientWidth]"
    tab.run("document.querySelectorAll('details').forEach(folded => { folded.open = true; })")
    images = tab.run(f"Array.from(document.querySelectorAll('main img'), {sizes})")
    assert len(images) == 5 + 3  # the paper's in small too
    # only on a telephone does a picture scroll sideways, in its own frame, so that its letters can be read
    assert all(0 < shown <= (640 if width == 390 else frame) and frame <= width and i for i, shown, frame in images)
    assert tab.run(WIDER) == [] and tab.run("document.documentElement.scrollWidth") == width
    assert tab.run("getComputedStyle(document.body).backgroundColor") == (
        "rgb(255, 255, 255)" if scheme == "light" else "rgb(20, 24, 29)"
    )
    for kind in ("not measured", "derivation", "in part"):
        tab.run(f"document.getElementById('only-{kind.replace(' ', '_')}').click()")
        rows = "Array.from(document.querySelectorAll('tr.claim')).filter(row => row.offsetHeight).length"
        assert tab.run(rows) == sum(row["verdict"] == kind for row in judged["table"])


def test_a_link_unfolds_what_it_leads_to_and_a_count_shows_its_claims(opened):
    tab = opened(1400)
    tab.run("location.hash = '#words'")
    tab.wait("document.getElementById('words').parentElement.open", 5.0)
    tab.click(*tab.centre("#tiles-ordered .tile")[:2])
    tab.wait("!document.getElementById('only-all').checked", 5.0)
    assert tab.problems == []


def test_what_a_reader_touches_has_a_name_and_is_large_enough(opened):
    tab = opened(390)
    unnamed = (
        "Array.from(document.querySelectorAll('a, button, input, summary, canvas')).filter(e => e.offsetHeight &&"
        " !(e.textContent || e.getAttribute('aria-label') || e.labels?.length)).map(e => e.outerHTML.slice(0, 80))"
    )
    assert tab.run(unnamed) == []
    low = "Array.from(document.querySelectorAll('nav a, .tile, #explorer button')).map(e => e.offsetHeight)"
    assert min(tab.run(low)) >= 24
    levels = tab.run("Array.from(document.querySelectorAll('h1, h2, h3'), e => Number(e.tagName[1]))")
    assert levels[0] == 1 and all(b <= a + 1 for a, b in itertools.pairwise(levels))
    outside = "Array.from(document.body.children).filter(e => !['A', 'HEADER', 'NAV', 'MAIN', 'SCRIPT', 'DIALOG']"
    assert tab.run(outside + ".includes(e.tagName)).length") == 0


def test_a_picture_is_enlarged_by_key_and_closed_by_mouse(opened):
    tab = opened(1400)
    tab.run("location.hash = '#picture-numerics'")
    tab.wait("document.querySelector('#picture-numerics').offsetHeight", 5.0)
    tab.run("document.querySelector('#picture-numerics img').focus()")
    tab.key("Enter", 13)
    assert tab.run("document.querySelector('dialog').open")
    assert tab.run("document.querySelector('dialog img').src === document.querySelector('#picture-numerics img').src")
    tab.click(*tab.centre("dialog button")[:2])
    assert not tab.run("document.querySelector('dialog').open")
    assert tab.problems == []


def test_the_explorer_follows_mouse_and_keys(opened):
    tab = opened(1400)
    assert force(tab)[0] == "90 mg"  # the nearest of 1, 4 and 90 to 20
    before = drawn(tab)
    x, y, width = tab.centre("#force")
    tab.drag(x + 0.49 * width, y, x - 0.49 * width)
    (said, words), now = force(tab), drawn(tab)
    assert said == "1 mg" and words.startswith("F = 1 mg: 0 contacts opened, 23 at the Coulomb limit.")
    # the response of these slabs is the same under every force
    assert [a != b for a, b in zip(before, now, strict=True)] == [True, False, True, True]
    tab.key("ArrowRight", 39)
    assert force(tab)[0] == "4 mg"
    tab.key("End", 35)
    assert force(tab)[0] == "90 mg" and drawn(tab) == before
    tab.click(*tab.centre("#paper button")[:2])
    assert force(tab)[0] == "4 mg"
    assert "ordered packing" in tab.run("document.getElementById('network').getAttribute('aria-label')")
    tab.click(*tab.centre("input[name=friction][value='0.0']")[:2])
    assert "µ = 0, " in tab.run("document.getElementById('network').getAttribute('aria-label')")
    assert tab.problems == []


def test_the_value_under_the_pointer_is_shown(opened):
    tab = opened(1400)
    shown = "(e => e.hidden ? '' : e.textContent)(document.getElementById('value'))"
    for panel, expected in (("floor", f"x = 0 R\u0304: {1 / 7:.4f}"), ("range", f"F = 4 mg: {1 / 7:.4f}")):
        x, y, width = tab.centre(f"#{panel}")
        seen = set()
        for across, over in itertools.product(np.linspace(0.0, 0.4 * width, 20), np.linspace(-140.0, 140.0, 20)):
            tab.hover(x + across, y + over)
            seen.add(tab.run(shown))
            if expected in seen:
                break
        assert expected in seen
    tab.hover(0.0, 0.0)
    assert tab.run(shown) == "" and tab.problems == []


def test_the_force_grows_by_itself_and_stops_at_the_end(opened):
    tab = opened(1400)
    assert force(tab)[0] == "90 mg"
    tab.click(*tab.centre("#play")[:2])
    assert tab.run("document.getElementById('play').textContent") == "Stop" and force(tab)[0] != "90 mg"
    tab.wait("document.getElementById('play').textContent === 'Play'", 10.0)
    assert force(tab)[0] == "90 mg" and tab.problems == []


def test_a_link_leads_to_a_state(opened):
    tab = opened(1400)
    tab.run("location.hash = '#mu=1&F=3'")
    tab.wait("document.getElementById('force').getAttribute('aria-valuetext') === '4 mg'", 5.0)
    assert "µ = 1," in tab.run("document.getElementById('about').textContent")
    assert tab.run("document.getElementById('link').hash") == "#mu=1&F=4"
    assert tab.problems == []


@pytest.fixture(scope="module")
def stepped(tab, root, tmp_path_factory):
    """The stored datasets, and what the explorer says of a state of them."""
    if missing := [group for group in report.EXPLORED if not (ROOT / "data" / f"{group}.nc").exists()]:
        pytest.skip(f"not simulated yet: {', '.join(missing)}")
    folder = tmp_path_factory.mktemp("stepped")
    (folder / "figures").mkdir()
    shutil.copy(root / "figures" / "claims.json", folder / "figures")
    (folder / "data").symlink_to(ROOT / "data")
    path = report.write(folder / "figures" / "report.html", folder)
    del tab.problems[:]
    tab.open(path, 1400)
    tab.wait("'ready' in document.getElementById('explorer').dataset")

    tab.run(
        "window.choose = (mu, index) => {"
        " document.querySelectorAll('input[name=friction]').forEach(i => { if (Number(i.value) === mu) i.click(); });"
        " const slider = document.getElementById('force'); slider.value = index;"
        " slider.dispatchEvent(new Event('input'));"
        " return ['force-label', 'about', 'said'].map(id => document.getElementById(id).textContent); }; 0"
    )

    def say(friction, applied, index):
        label, about, words = tab.run(f"choose({friction}, {index})")
        assert label == f"F = {applied:g} mg"
        assert "ordered" in about and f"µ = {friction:g}," in about
        return words.replace("\u2212", "-")

    yield {group: store.read(ROOT / "data" / f"{group}.nc") for group in report.EXPLORED}, say
    assert tab.problems == []


def network(states, friction):
    """Of each state the numbers of opened contacts and of those at the Coulomb limit within 30 R of the load."""
    rest = states["position"].values[0, :, 0]
    near = np.abs(rest - rest[int(states["loaded_disk"])]) <= 30.0
    shown = near[states["contact_disk"].values] & near[states["contact_partner"].values]
    touching = states["contact_status"].values[:, shown] != 0
    normal, across = (states[f"contact_{k}_force"].values[:, shown].astype(float) for k in ("normal", "tangential"))
    sliding = touching & (np.abs(across) >= 0.99 * friction * normal) if friction else np.zeros_like(touching)
    return (touching[0] & ~touching).sum(axis=1), sliding.sum(axis=1)


def crossover_said(phase, friction):
    """What Fig. 22 has for the lattice."""
    one = phase["crossovers"].sel(width=6.0)
    one = one.isel(
        case=(one["polydispersity"].values == 0.0)
        & (one["friction"].values == friction)
        & (one["lattice_constant"].values == "touching-largest")
    )
    words = ("two peaks from {} mg on.", "two peaks already below {} mg.", "two peaks not up to {} mg.")
    two_digits = float(f"{one['force'].item():.2g}")
    return words[int(one["kind"].item())].format(f"{two_digits:g}")


def hold(words, counts, measured, phase, friction):
    """The sentence of one state against what is stored of it; ``measured`` is x = 0, and peaks and asymmetry."""
    opened, sliding = counts
    centre, peaks, asymmetry = measured
    assert f": {opened} contact{'s' if opened != 1 else ''} opened, {sliding} at the Coulomb limit." in words
    assert f"The response (smooth walls) has {peaks} peak{'s' if peaks > 1 else ''}, " in words
    assert f" is {'not ' if asymmetry > 0.2 else ''}symmetric, and is {centre:.4f} at x = 0;" in words
    walls = "rough" if friction else "smooth"
    assert f"Fig. 22 ({walls} walls, smoothed with w = 6 R\u0304): {crossover_said(phase, friction)}" in words


def one_peak_then_more(said):
    """No sentence of a slab denies another: ``said`` are forces, numbers of peaks and sentences."""
    for applied, peaks, words in said:
        first = re.search(r"This slab has one peak up to ([\d.]+) mg(?: and more from ([\d.]+) mg on)?\.", words)
        assert first and (applied <= float(first[1])) == (peaks == 1)
        assert first[2] is None or (applied >= float(first[2])) == (peaks > 1)


@pytest.mark.parametrize("friction", [0.0, 0.2, 1.0])
def test_every_sentence_of_an_ordered_slab_is_what_is_stored(stepped, friction):
    data, say = stepped
    study = data["friction_linear_range"]
    path, large = study[f"states_mu_{friction:g}"], study["large_forces"]
    own = study["response"].sel(friction=friction)
    first = float(large["force"].min()) if float(large["friction"]) == friction else np.inf
    parts = [(path, own, path["force"].values[1:], "load path")]
    if np.isfinite(first):
        states = study["large_force_states"]
        below = path["force"].values[1:]
        parts = [(path, own, below[below < first], "load path")]
        parts += [(states, large, states["force"].values[1:], "dynamics from rest")]
    said = []
    for states, response, forces, reached in parts:
        counts = network(states, friction)
        for applied in forces:
            state = int(np.flatnonzero(states["force"].values == applied)[0])
            one = response.sel(force=applied)
            peaks = int(one["peak_count"])
            words = say(friction, applied, len(said))
            measured = float(one["response_at_centre"]), peaks, float(one["asymmetry"])
            hold(words, [count[state] for count in counts], measured, data["phase_diagram"], friction)
            assert (f"({reached})" in words) == np.isfinite(first)
            said.append((applied, peaks, words))
    one_peak_then_more(said)


def test_the_explorer_follows_a_finger(opened):
    tab = opened(390)
    x, y, width = tab.centre("#force")
    tab.touch(x - 0.49 * width, y)
    tab.wait("document.getElementById('force').getAttribute('aria-valuetext') === '1 mg'", 5.0)
    x, y, _ = tab.centre("#paper button")
    tab.touch(x, y)
    tab.wait("document.getElementById('force').getAttribute('aria-valuetext') === '4 mg'", 5.0)
    assert tab.problems == []


def test_without_scripts_there_are_no_dead_controls(opened, tab):
    try:
        tab = opened(1400, scripts=False)
        heights = tab.run(
            "Array.from(document.querySelectorAll('button, canvas, input[type=range]'), e => e.offsetHeight)"
        )
        assert heights and not any(heights)
        assert tab.run("document.body.innerText.includes('The explorer needs JavaScript')")
    finally:
        tab.call("Emulation.setScriptExecutionDisabled", value=False)


def test_the_page_can_be_printed(opened):
    tab = opened(1400, scheme="dark")
    printed = tab.pdf()
    assert printed.startswith(b"%PDF") and 3 <= len(re.findall(rb"/Type\s*/Page\b", printed)) <= 40
    paper = {"width": 717, "height": 1058, "deviceScaleFactor": 1, "mobile": False}  # A4 less its margins
    tab.call("Emulation.setDeviceMetricsOverride", **paper)
    tab.call("Emulation.setEmulatedMedia", media="print", features=[])
    cut = tab.run(
        "Array.from(document.querySelectorAll('body *')).filter(e => e.offsetWidth && !['SCRIPT', 'STYLE'].includes("
        "e.tagName) && e.getBoundingClientRect().right > document.documentElement.clientWidth + 1).length"
    )
    assert cut == 0
    tab.call("Emulation.setEmulatedMedia", media="", features=[])
    assert tab.problems == []
