"""The page: what it says agrees with the stored table, and it needs no network."""

import base64
import html
import json
import re
import zlib
from collections import Counter
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest
from claims_data import by_row, dataset, over
from PIL import Image
from places import ROOT
from refusals import refuses

from granular_response.store import files as store
from granular_response_paper import report
from granular_response_paper.claims import table as claims
from granular_response_paper.claims.claim import ClaimsError, Data, judge
from granular_response_paper.registry import PAPER, collections
from granular_response_paper.report import against, explorer, forest, readings
from granular_response_paper.report.typeset import typeset

FORCES = (0.0, 1.0, 4.0, 90.0)
#: Claims whose sentences stand beside the explorer or above a chapter.
TOLD = {one["claim"] for one in report.SAID["findings"]} | {one["answer"] for one in report.SAID["chapters"]}


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
    return dataset(
        position=("state disk axis", [place] * len(FORCES)),
        **over("contact", contact_disk=first, contact_partner=second),
        **over("state contact", contact_status=status, contact_normal_force=np.where(status == 0, 0.0, normal)),
        contact_tangential_force=("state contact", friction * normal),
        force=("state", FORCES),
        loaded_disk=10,
    )


def friction_study():
    response = dataset(
        {"friction": [0.0, 0.2, 1.0], "force": list(FORCES[1:]), "x": ("floor_disk", np.arange(-6.0, 7.0, 2.0))},
        floor_response=("friction force floor_disk", 1.0 / 7.0),
        **over("friction force", peak_count=2.0, response_at_centre=1.0 / 7.0),
    )
    comes = [(name, mu, 3.0, 3.5) for mu, *_, names in explorer.PAPER for name in names]
    events = dataset(by_row("event", "name friction low high", comes))
    states_of = {f"states_mu_{mu:g}": states(mu) for mu in (0.0, 0.2, 1.0)}
    found = {"response": response, "events": events, **states_of}
    for one in found.values():
        one.attrs["scene"] = "contact: {stiffness_ratio: 0.8}\nwall: {friction: 0.0}\n"
    return found


def sensitivity_study():
    return dataset(
        {"variant": ["reference", "of_its_own"]},
        **over("variant", largest_difference=[0.0, 8e-6], text=["as it is", "time step <halved>"]),
    )


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A folder as the pipeline leaves it, with some of the figures."""
    folder = tmp_path_factory.mktemp("project")
    for name, size in {
        "theory/fig01_predictions": (1400, 500),
        "friction_linear_range/fig06_linear_range": (680, 520),
        "pile_dip/fig17_pile": (1400, 900),
        "pile_dip/fig17b_profiles": (700, 300),
        "overview/overview": (1240, 980),
    }.items():
        path = folder / "figures" / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        shade = np.linspace(0, 255, size[0] * size[1] * 3).reshape(size[1], size[0], 3).astype(np.uint8)
        Image.fromarray(shade).save(path)
        beside = path.with_name("captions.json")
        said = json.loads(beside.read_text()) if beside.exists() else {}
        caption = f"What {path.stem} <shows>. And more. µ = 0.2."
        said[path.stem] = {"title": "A title", "caption": caption, "alternative": "", "parameters": {"friction": 0.2}}
        beside.write_text(json.dumps(said))
    store.write(folder / "data" / "friction_linear_range.nc", friction_study())
    store.write(folder / "data" / "phase_diagram.nc", {"crossovers": crossovers()})
    store.write(folder / "data" / "sensitivity.nc", {"mu_0.2": sensitivity_study()})
    data = Data({"friction_linear_range": friction_study()})
    judged = claims.document([judge(claim, data) for claim in claims.claims_in(PAPER)])
    (folder / "figures" / "claims.json").write_text(json.dumps(judged | {"quantities": QUANTITIES}))
    return folder


def point(value, low, high, **others):
    return {"value": value, "interval": [low, high], **others}


QUANTITIES = [
    {"what": "two peaks, friction 0.2", "paper": 20.0, "unit": "mg", "claim": "R3a", "others": [
        point(0.15, 0.15, 0.15, case="gravity ramped over 100 sqrt(R/g)", prepared="gravity"),
        point(None, 40.0, None, case="gravity first without friction", prepared="gravity"),
        point(35.0, 0.0, 70.0, case="121 disks a row", prepared=""),
    ], "ours": point(20.2, 17.4, 20.4, text="20 mg (17 to 20 mg)", interval_of="range over the protocol")},
    {"what": "change of the response with k_N", "paper": 0.02, "unit": "%", "claim": "F8", "others": [],
     "ours": point(2.8e-5, 2.8e-5, 2.8e-5, text="0.0028 %", interval_of="none")},
]  # fmt: skip


def pages_of(folder, collection=PAPER):
    """The page and that of the claims."""
    made = report.files(folder, collection)
    return made["report.html"].decode(), made["claims.html"].decode()


@pytest.fixture(scope="module")
def page(root):
    return pages_of(root)[0]


@pytest.fixture(scope="module")
def claims_page(root):
    return pages_of(root)[1]


def words(text):
    """What a page shows, without its scripts and styles."""
    return html.unescape(re.sub(r"<[^>]+>", " ", re.sub(r"<(script|style).*?</\1>", "", text, flags=re.DOTALL)))


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


def test_one_row_for_every_claim_with_its_verdict(judged, page, claims_page):
    elements = Elements(claims_page)
    rows = [row["id"] for row in elements.named("tr") if row.get("class", "").startswith("claim ")]
    assert rows == [f"claim-{row['id']}" for row in judged["table"]]
    chips = [span["class"] for span in elements.named("span") if span.get("class", "").startswith("chip")]
    assert chips == [f"chip {row['verdict'].replace(' ', '_')}" for row in judged["table"]]
    for part in ("ordered", "disorder"):
        counts = page.partition(f'id="counts-{part}"')[2].partition("</span>")[0]
        found = {verdict: int(number) for verdict, number in re.findall(r'#only-(\w+)">(\d+) ', counts)}
        assert found == {verdict: number for verdict, number in judged["counts"][part].items() if number}
    for sentence in judged["scheme"]:
        assert f"<li>{sentence}</li>" in page and f"<li>{sentence}</li>" in claims_page
    assert "What fig17_pile &lt;shows&gt;." in page and "<shows>" not in page  # texts from data cannot become markup


@cache
def everything(collection):
    """The stored page of a collection and that of its claims."""
    return pages_of(ROOT / collection.folder, collection)


@pytest.mark.parametrize("collection", collections(), ids=lambda one: one.name)
def test_the_stored_page_says_each_sentence_once_in_few_words_and_all_its_links_are_good(collection):
    page, claims_page = everything(collection)
    table = claims.read(ROOT / collection.folder / claims.OUTPUT)["table"]
    for here, rows in Counter(row["here"] for row in table if row["verdict"] != "not measured").items():
        assert page.count(typeset(here)) <= rows, here
    assert len(words(page).split()) <= 8000
    ids = {name: {e["id"] for _, e in Elements(text).found if "id" in e} for name, text in
           (("report.html", page), ("claims.html", claims_page))}  # fmt: skip
    for name, text in (("report.html", page), ("claims.html", claims_page)):
        for link in (a["href"] for a in Elements(text).named("a")):
            path, _, target = link.partition("#")
            if path in ("", *ids):
                assert not target or target.startswith("mu=") or target in ids[path or name], link
            else:
                assert (ROOT / collection.folder / "figures" / path).exists() or path.endswith(".nc"), link


def test_every_statement_of_the_paper_that_fails_and_every_finding_is_said_on_the_stored_page():
    page, _ = everything(PAPER)
    table = {row["id"]: row for row in claims.read(ROOT / claims.OUTPUT)["table"]}
    failing = [name for name, row in table.items() if row["verdict"] == "not supported" and row["row"] == "statement"]
    for name in {*failing, *TOLD}:
        assert page.count(typeset(table[name]["here"])) == 1, name
    numbers = re.findall(r"\d+\.\d+", " ".join(row["here"] for row in table.values()))
    assert numbers and all(len(number.replace(".", "").lstrip("0")) <= 4 for number in numbers)


def test_the_extensions_answer_each_question_with_its_own_picture():
    answered = report.answers(ROOT / report.ANSWERS)
    pictures = [stem for _, _, stem in answered]
    assert len(answered) > 5 and all(pictures) and len(set(pictures)) == len(pictures)
    assert all(list((ROOT / "extensions" / "figures").glob(f"*/{stem}.png")) for stem in pictures)


def test_numbers_stand_at_their_ratio_to_the_papers_and_bounds_are_arrows():
    axes = forest.forest(QUANTITIES).axes[0]
    drawn = {
        (line.get_marker(), round(float(line.get_xdata()[0]), 4)) for line in axes.lines if len(line.get_xdata()) == 1
    }
    # gravity, its bound, the bracket that begins at no force, ours, and a number beyond the axis
    assert {("o", 0.0075), (">", 2.0), ("<", 3.5), ("o", 1.01), ("<", forest.ENDS[0])} <= drawn
    said = [text.get_text() for text in axes.texts]
    assert said == ["paper", "here", "20 mg", "20 (17 to 20)", "2 %", "0.0028"]
    assert forest.render({"quantities": []}) == {}
    again = forest.render({"quantities": QUANTITIES})
    assert list(again) == list(forest.FILES) and again == forest.render({"quantities": QUANTITIES})


def test_the_page_needs_no_network_and_no_file_but_its_pictures(page):
    elements = Elements(page)
    assert [link["href"] for link in elements.named("link")] == ["data:,"]
    assert not [script for script in elements.named("script") if "src" in script]
    assert not re.search(r"(?:https?:)?//[\w.]+\.\w+/", re.sub(r"base64,[\w+/=]+", "", page))
    assert "url(" not in page and "@import" not in page


def test_every_figure_of_the_paper_has_a_place(page):
    assert sorted(map(int, re.findall(r' id="figure-(\d+)"', page))) == list(range(1, 25))
    assert page.count("is not drawn yet") == 24 - 3
    assert page.count('<figure id="picture-') == 4 + 3  # of figures; the overview and the two of the claims
    assert page.count("<b>Fig. 17. A title. What fig17") == 2
    assert "<summary>Parameters</summary><p>µ = 0.2." in page
    targets = set(re.findall(r'href="#([\w-]+)"', page))
    assert targets <= {e["id"] for _, e in Elements(page).found if "id" in e}


def test_the_same_files_give_the_same_page_and_no_other_file(root):
    before = set(root.rglob("*"))
    path = report.write(root)
    made = {one.name for one in set(root.rglob("*")) - before}
    assert made == {"report.html", "claims.html", "forest.png", "preparations.png"}
    text = path.read_bytes()
    assert report.write(root).read_bytes() == text == report.files(root)["report.html"]


def test_claims_and_figures_lead_to_each_other(judged, page, claims_page):
    def listed(text, mark, end):
        return text.partition(mark)[2].partition(end)[0]

    for row in judged["table"]:
        part = listed(claims_page, f'<tr id="claim-{row["id"]}"', "</tr>")
        assert [int(number) for number in re.findall(r'href="report.html#figure-(\d+)"', part)] == row["figures"]
    for number in (1, 6, 17):
        part = listed(page, f'<section id="figure-{number}"', "</section>")
        shown = re.findall(r'<a class="mark \w+" href="claims.html#claim-(\w+)">', part)
        own = [r["id"] for r in judged["table"] if r["figures"][:1] == [number] and r["row"] == "statement"]
        assert set(shown) <= set(own) and len(set(shown) - TOLD) == min(report.LISTED, len(set(own) - TOLD))
        assert f"make figure FIGURE={number}<" in part


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


def crossovers():
    largest = "touching-largest"
    cases = [(0.0, 1.0, largest, 0.0), (0.0, 0.2, largest, 0.0), (0.25, 0.2, largest, 0.0), (0.25, 1.0, "2.0", 0.0)]
    return dataset(
        by_row("case", "polydispersity friction lattice_constant gravity_ramp", cases) | {"width": [6.0]},
        **over("width case", force=[[3.0, 20.0, 5.0, 9.0]], kind=[[0, 2, 1, 0]]),
        interval=("width case level", [[[3.0, 3.0], [20.0, np.inf], [0.0, 6.0], [8.0, 9.5]]]),
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
    data = explorer.payload(friction_study(), {"crossovers": crossovers()})
    assert [slab["friction"] for slab in data["slabs"]] == [0.0, 0.2, 1.0]
    assert all(slab["forces"] == [1.0, 4.0, 90.0] for slab in data["slabs"])  # at rest nothing is added
    smooth, slight, rough = unpacked(data)
    opened = (smooth[1] == explorer.OPENED).sum(axis=1).tolist()
    assert opened == [0, *[int((states(0.0)["contact_status"].values[2] == 0).sum())] * 2] and opened[1] > 0
    # every closed contact gets as much as the applied force; tangential forces add as a vector
    strongest = np.sqrt(2.0) * 1.0
    assert data["strongest"] == pytest.approx(strongest, rel=1e-6)
    assert set(smooth[1][0]) == {round(explorer.FULL * np.sqrt(1.0 / strongest))}
    assert set(rough[1][0]) == {explorer.FULL}
    # with friction the tangential forces are at the Coulomb limit; without it nothing slides
    assert slight[2][0].all() and rough[2][0].all() and not smooth[2].any()
    assert data["slabs"][0]["response"] == [[0.1429] * 7] * 3 and data["slabs"][0]["peaks"] == [2, 2, 2]
    assert data["slabs"][0]["about"] == "ordered packing, µ = 0, µ_wall = 0, k_N = 3000 mg/R"
    assert [one["friction"] for one in data["range"]] == [0.0, 0.2, 1.0]
    assert data["range"][0]["force"] == [1.0, 4.0]  # Fig. 6 ends at 50


@pytest.mark.parametrize(("content", "problem"), [(None, "No such file"), ("{", "Expecting"), ("[]", "is not a")])
def test_a_missing_or_damaged_table_is_one_line(tmp_path, content, problem):
    if content is not None:
        (tmp_path / "figures").mkdir()
        (tmp_path / "figures" / "claims.json").write_text(content)
    refuses(ClaimsError, rf"claims\.json: {problem}", report.files, tmp_path)
