"""The page: all there, well formed, pointing nowhere, and harmless whatever the files say."""

import base64
import hashlib
import json
from html.parser import HTMLParser

import pytest
from made_up import CONFIG, EVIL

from tetgan.errors import UserError
from tetgan.report import figures, solids
from tetgan.report.page import MOST_BYTES, report_page

VOID = {"meta", "link", "img", "input", "br", "hr"}


class Reader(HTMLParser):
    """Elements of a page with the text in each, and every address; checks that tags pair up."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.addresses, self.ids = [], [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        element = {"tag": tag, "text": "", **dict(attrs)}
        self.elements.append(element)
        self.addresses += [value for name, value in attrs if name in ("src", "href", "action", "srcset")]
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in VOID:
            self.open.append(element)

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop()["tag"] == tag

    def handle_data(self, data):
        for element in self.open:
            element["text"] += data

    def all(self, tag):
        return [element for element in self.elements if element["tag"] == tag]


@pytest.fixture(scope="module")
def read(page):
    return Reader(page.read_text())


def test_every_table_is_there_with_its_file(read, results):
    wanted = {path.name: path.read_bytes() for path in results.glob("tables/*.csv")}
    wanted["resolution.csv"] = (results / "figures/resolution.csv").read_bytes()
    links = {link["download"]: link["href"] for link in read.all("a") if "download" in link}
    assert {name: content_of(uri, "text/csv") for name, uri in links.items()} == wanted
    headings = [heading["text"] for heading in read.all("h3")]
    assert headings.index("chair") < headings.index("manifold")


def test_every_figure_is_there_byte_for_byte(read, results):
    wanted = {path.read_bytes() for path in results.glob("figures/**/*.png")}
    assert {content_of(image["src"], "image/png") for image in read.all("img")} == wanted
    captions = [caption["text"] for caption in read.all("figcaption")]
    assert len(captions) == 3
    assert any("Between two chairs." in caption for caption in captions)


def content_of(uri, kind):
    start = f"data:{kind};base64,"
    assert uri.startswith(start)
    return base64.b64decode(uri.removeprefix(start), validate=True)


def test_the_table_shown_is_the_markdown_twin(read):
    head = [cell["text"] for cell in read.all("th")]
    assert "FID ↓" in head
    assert "m13" not in head  # of the CSV
    assert [span["text"] for span in read.all("span") if span.get("class") == "paper"][1] == "(paper 2.09)"
    assert [span["text"] for span in read.all("span") if span.get("class") == "interval"] == ["[0.2, 0.3]"]
    figures = [cell for cell in read.all("td") if cell["text"].startswith("0.25 [")]
    assert figures[0]["class"] == "number"
    assert "0.9891" in [cell["text"] for cell in read.all("td")]


def test_nothing_is_fetched_from_anywhere(read):
    assert all(address.startswith(("data:", "#")) for address in read.addresses)
    assert not read.all("iframe") and not read.all("object")
    targets = {address[1:] for address in read.addresses if address.startswith("#")}
    assert targets <= set(read.ids)
    assert len(read.ids) == len(set(read.ids))


def test_text_of_files_stays_text(read, page):
    # Ours, and the data of the viewer; the file's would be a third.
    assert len(read.all("script")) == 2
    assert EVIL not in page.read_text()
    assert sum(EVIL in cell["text"] for cell in read.all("td")) == 2
    assert any(EVIL in block["text"] for block in read.all("pre"))
    assert "[a link](https://example.org/x)" in "".join(text["text"] for text in read.all("p"))


def test_only_our_script_may_run(read):
    policy = next(
        meta["content"] for meta in read.all("meta") if "content" in meta and "-src" in meta["content"]
    )
    script = next(script for script in read.all("script") if "type" not in script)
    digest = base64.b64encode(hashlib.sha256(script["text"].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy


def test_the_viewer_gets_the_first_solids_of_the_lowest_seed(read):
    packed = json.loads(next(part["text"] for part in read.all("script") if "type" in part))
    assert [one["model"] for one in packed] == ["pca", "tetgan-LR"]
    assert {one["seed"] for one in packed} == {0}
    assert [solid["id"] for solid in packed[0]["solids"]] == ["0000", "0001", "0002"]
    assert len(read.all("option")) == 2 + 3 + 4


def test_provenance_names_seeds_versions_times_and_the_config(read):
    cells = [cell["text"] for cell in read.all("td")]
    for text in (
        "sources.chair.seed",
        "0, 1",
        "numpy",
        "python",
        "repair_shapes",
        "2.00",
        "10.00",
        "123",
        "a GPU",
    ):
        assert text in cells
    assert "builtin" in read.all("pre")[0]["text"]


def test_the_same_results_give_the_same_page(page, results, captions, tmp_path):
    again = tmp_path / "again.html"
    report_page(results, again, config=CONFIG, captions=captions)
    assert again.read_bytes() == page.read_bytes()


def test_full_budgets_leave_a_page_of_moderate_size(page):
    in_base64 = 4 / 3
    assert in_base64 * figures.BUDGET + solids.BUDGET + page.stat().st_size < MOST_BYTES


def test_an_evil_id_of_a_solid_stays_data(results, ball, captions, tmp_path):
    for name in ("tables", "figures", "benchmarks"):
        (tmp_path / name).symlink_to(results / name)
    from_files = results / "samples/chair/pca/0/paper/wls/generated/0000.vtu"
    into = tmp_path / "samples/chair/pca/0/paper/wls/generated"
    into.mkdir(parents=True)
    evil = "<!--<script>&quot;"
    (into / f"{evil}.vtu").write_bytes(from_files.read_bytes())
    report_page(tmp_path, tmp_path / "report.html", config={}, captions=None)
    read = Reader((tmp_path / "report.html").read_text())
    packed = json.loads(next(part["text"] for part in read.all("script") if "type" in part))
    assert packed[0]["solids"][0]["id"] == evil


def test_an_empty_folder_is_an_error_that_says_what_is_missing(tmp_path):
    with pytest.raises(UserError, match="no tables"):
        report_page(tmp_path, tmp_path / "report.html", config={}, captions=None)
    assert not (tmp_path / "report.html").exists()


def test_tables_alone_make_a_page(tmp_path):
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables/one.csv").write_text("a,b\n1,2\n")
    report_page(tmp_path, tmp_path / "report.html", config={}, captions=None)
    read = Reader((tmp_path / "report.html").read_text())
    assert not read.all("canvas") and not read.all("script")
