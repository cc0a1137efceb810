"""Files and folders appear whole or not at all."""

import pytest

from tetgan.errors import UserError
from tetgan.files import check_suffix, whole_file, whole_folder


def test_a_file_appears_only_when_the_block_ends(tmp_path):
    target = tmp_path / "deep" / "table.csv"
    with whole_file(target) as partial:
        partial.write_text("done")
        assert partial.suffix == target.suffix
        assert not target.exists()
    assert target.read_text() == "done"
    assert list(target.parent.iterdir()) == [target]


def test_an_error_keeps_the_older_file_and_leaves_no_rest(tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("old")
    with pytest.raises(RuntimeError), whole_file(target) as partial:
        partial.write_text("half")
        raise RuntimeError
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_an_error_of_the_system_names_the_file_that_was_asked_for(tmp_path):
    target = tmp_path / "folder"
    target.mkdir()
    (target / "inside").touch()
    with pytest.raises(OSError, match="folder") as told, whole_file(target) as partial:
        partial.write_text("new")
    assert told.value.filename == str(target)


def test_another_suffix_is_told_with_those_that_there_are():
    check_suffix("deep/table.CSV", "a table", ".csv")
    with pytest.raises(UserError, match=r"^a/b\.txt: a figure is written as \.png or \.pdf; change"):
        check_suffix("a/b.txt", "a figure", ".png", ".pdf")


def test_a_folder_replaces_an_older_one_only_when_whole(tmp_path):
    target = tmp_path / "samples"
    target.mkdir()
    (target / "stale").touch()
    with pytest.raises(RuntimeError), whole_folder(target, "stale") as partial:
        (partial / "half").touch()
        raise RuntimeError
    assert [path.name for path in target.iterdir()] == ["stale"]
    with whole_folder(target, "stale") as partial:
        (partial / "new").touch()
    assert [path.name for path in target.iterdir()] == ["new"]
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("mark", ["report.json", "*/certificate.csv"])
def test_a_folder_of_other_things_is_not_replaced(tmp_path, mark):
    target = tmp_path / "chairs"
    (target / "none").mkdir(parents=True)
    (target / "none" / "mine.obj").touch()
    with (
        pytest.raises(UserError, match="chairs: holds other things, which would be lost"),
        whole_folder(target, mark),
    ):
        pytest.fail("must not be reached")
    assert (target / "none" / "mine.obj").exists()
    (target / mark.replace("*", "none")).touch()
    with whole_folder(target, mark) as partial:
        (partial / "new").touch()
    assert [path.name for path in target.iterdir()] == ["new"]
