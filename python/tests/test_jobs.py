# SPDX-License-Identifier: GPL-3.0-or-later
import time

import pytest

import voxtone
from voxtone.job import _running

from conftest import box


def test_events_come_by_iteration_and_by_callback(tmp_path):
    told = []
    job = voxtone.slice(box(), out=tmp_path / "box", quality="draft", predict="none", progress=told.append)
    seen = list(job)
    stack = job.result()
    assert job.done and seen == told == job.events
    assert seen[-1]["event"] == "result" and seen[-1]["result"]["layers"] == stack.shape[0]
    layers = [e for e in seen if e.get("stage") == "layers"]
    assert layers[0]["state"] == "begin" and layers[-1]["state"] == "end"
    assert list(job) == seen  # again from the first
    assert job not in _running


def test_a_mesh_becomes_part_of_its_stack(tmp_path):
    """So that the job can be made again, and nothing is left where it is refused."""
    out = tmp_path / "box"
    job = voxtone.slice(box(), out=out, quality="draft", predict="none", layers="0-9")
    first = job.result()
    assert "few-layers" in [warning.name for warning in job.warnings]
    assert (out / "models/model.glb").exists()
    again = voxtone.slice(job=out / "job.json", out=tmp_path / "again").result()
    assert again.manifest["content_sha256"] == first.manifest["content_sha256"]
    refused = tmp_path / "refused"
    with pytest.raises(voxtone.Error):
        voxtone.slice(box(), out=refused, size="nonsense").result()
    assert not refused.exists()


def test_several_meshes_are_one_print_that_can_be_made_again(tmp_path):
    out = tmp_path / "tray"
    parts = [box(), box((4, 4, 4))]
    quick = dict(quality="draft", predict="none", report=False)
    first = voxtone.slice(*parts, out=out, **quick).result()
    assert sorted(file.name for file in (out / "models").iterdir()) == ["model.glb", "model2.glb"]
    assert not [file for file in out.rglob("*.json") if "/voxtone-" in file.read_text()]
    # The same call makes the same print; another mesh by the same name is another file, and what is not ours stays.
    (out / "model.glb").write_bytes(b"somebody's own")
    again = voxtone.slice(*parts, out=out, overwrite=True, **quick).result()
    assert again.manifest["content_sha256"] == first.manifest["content_sha256"]
    voxtone.slice(box((5, 5, 5)), box((4, 4, 4)), out=out, overwrite=True, **quick).result()
    assert len(list((out / "models").iterdir())) == 3
    assert (out / "model.glb").read_bytes() == b"somebody's own"


def test_what_is_wrong_with_a_file_is_the_message(tmp_path):
    with pytest.raises(voxtone.Error, match="does not exist"):
        voxtone.read(tmp_path / "nothing.obj").result()
    with pytest.raises(voxtone.Error):  # nothing was made, and nothing of it is looked for
        voxtone.slice(tmp_path / "nothing.obj", out=tmp_path / "never").result()


def test_cancel(tmp_path):
    out = tmp_path / "large"
    with voxtone.slice(box((60, 60, 60)), out=out, quality="best") as job:
        for event in job:
            if event["event"] == "stage":
                job.cancel()
        with pytest.raises(voxtone.Cancelled):
            job.result()
    assert not (out / "manifest.json").exists()


def test_left_early_is_cancelled(tmp_path):
    began = time.monotonic()
    with voxtone.slice(box((60, 60, 60)), out=tmp_path / "large", quality="best") as job:
        with pytest.raises(TimeoutError):
            job.result(timeout=0)
    assert job.done and time.monotonic() - began < 60


def test_what_the_callback_throws_ends_the_job(tmp_path):
    def callback(_):
        raise KeyError("mine")
    with pytest.raises(KeyError, match="mine"):
        voxtone.slice(box((60, 60, 60)), out=tmp_path / "large", quality="best", progress=callback).result()


@pytest.mark.parametrize("kind, options, word", [
    (voxtone.UsageError, dict(size="60parsecs"), "60parsecs"),
    (voxtone.InputError, dict(printer="nobody's"), "nobody's"),
    (voxtone.FileError, dict(job="/nowhere/job.json"), "/nowhere/job.json")])
def test_exceptions_by_exit_code(tmp_path, kind, options, word):
    with pytest.raises(voxtone.Error, match=word) as caught:
        voxtone.slice(box(), out=tmp_path / "x", **options).result()
    assert caught.value.exit_code in (2, 3, 4)
    assert caught.value.name == {2: "usage", 3: "invalid-input", 4: "file"}[caught.value.exit_code]
    assert isinstance(caught.value, kind) or caught.value.exit_code != kind.exit_code
    assert not str(caught.value).startswith("voxtone:")


def test_no_program(monkeypatch):
    monkeypatch.setenv("VOXTONE_PROGRAM", "/nowhere/voxtone")
    with pytest.raises(voxtone.ProgramMissing, match="/nowhere/voxtone"):
        voxtone.version()
    monkeypatch.delenv("VOXTONE_PROGRAM")
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(voxtone.ProgramMissing, match="install"):
        voxtone.slice("cow.glb")


def test_estimate_needs_no_folder():
    told = voxtone.estimate(box(), size="20mm", quick=True).result()
    assert max(told["size_mm"]) == pytest.approx(20)
