"""Folders of samples: which part of them is shown, and the ids in it."""

import pandas as pd

from tetgan.solids.folder import finished_samples, sample_ids


def test_ids_come_from_the_certificate_or_the_files(tmp_path):
    (tmp_path / "none" / "generated").mkdir(parents=True)
    for name in ("b", "a"):
        (tmp_path / "none" / "generated" / f"{name}.ply").touch()
    folder = finished_samples(tmp_path)
    assert folder.name == "none"
    assert sample_ids(folder, "generated", 1) == ["a"]
    (tmp_path / "wls").mkdir()
    folder = finished_samples(tmp_path)
    table = pd.DataFrame({"set": ["generated", "reconstructed", "generated"], "id": ["0001", "x", "0002"]})
    table.to_csv(folder / "certificate.csv", index=False)
    assert folder.name == "wls"
    assert sample_ids(folder, "generated") == ["0001", "0002"]
