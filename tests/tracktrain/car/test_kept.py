"""FMUs that are kept for the runs that had them."""

from __future__ import annotations

from fmus.catalogue import fmu_path
from tracktrain.car import kept


def test_an_fmu_that_is_kept_is_not_written_again(tmp_path, monkeypatch):
    monkeypatch.setattr(kept, "FOLDER", tmp_path)
    whole = kept.keep(fmu_path("wheelrail")).with_suffix(".fmu")
    assert whole.read_bytes() == fmu_path("wheelrail").read_bytes()
    first = whole.stat()
    kept.keep(fmu_path("wheelrail"))
    assert (whole.stat().st_mtime_ns, whole.stat().st_ino) == (first.st_mtime_ns, first.st_ino)
    assert [path.name for path in tmp_path.iterdir()] == [whole.name]
