"""The page of the smoke run."""

from smoke_project import planned

PAGE = "results/smoke/report.html"


def test_a_page_depends_on_the_tables_that_are_there(untouched):
    table = untouched.folder / "results" / "tables" / "resolution.csv"
    plan = ("-n", "results/report.html")
    assert "tables/resolution.csv" not in untouched.snakemake(*plan).stdout
    table.parent.mkdir(parents=True)
    table.touch()
    found = untouched.snakemake(*plan)
    table.unlink()
    table.parent.rmdir()
    assert found.returncode == 0, found.stderr
    assert "results/tables/resolution.csv" in found.stdout


def test_the_smoke_run_makes_a_page_with_its_table_figure_and_solids(smoked):
    project, _, _ = smoked
    result = project.smoke(PAGE)
    assert result.returncode == 0, result.stdout + result.stderr
    page = (project.folder / PAGE).read_text()
    for text in ("<h3>chair</h3>", "chair: samples", "tetgan-LR", "train_model", "run: smoke"):
        assert text in page
    assert '"model": "tetgan-HR"' in page
    assert len(page) < 15_000_000
    assert planned(project.smoke("-n", PAGE)) == {}
