# SPDX-License-Identifier: GPL-3.0-or-later
"""What is changed and sliced again, what arrives in a folder, what Slurm runs."""
import json
import os
import time
from pathlib import Path

import pytest

import voxtone
from shops import Served, bits, console_bits, write_box

quick = {"iterations": 1, "predict": "none"}


def hand_in(shop, *files, **asked):
    return shop.ask("POST", "/jobs", {"upload": shop.upload(*files), **asked})["id"]


def stages_of(shop, job):
    events = [json.loads(line) for line in shop.request("GET", f"/jobs/{job}/log")[1].splitlines()]
    return [event["stage"] for event in events if event["event"] == "stage" and event["state"] == "begin"]


def loops_of(shop, job):
    return stages_of(shop, job).count("appearance loop")


@pytest.fixture(scope="module")
def shop(tmp_path_factory):
    served = Served(tmp_path_factory.mktemp("again") / "shop")
    yield served
    served.stop()


def test_what_a_change_does_not_touch_is_not_made_anew(shop, tmp_path):
    model = write_box(tmp_path / "box.glb", (2, 1.2, 1))
    first = hand_in(shop, model, options=quick)
    shop.wait_for(first, "done", seconds=120)
    assert loops_of(shop, first) == 1

    def again(**options):
        job = shop.ask("POST", "/jobs", {"job": first, "model": "box.glb", "options": {**quick, **options}})["id"]
        return job, shop.wait_for(job, "done", seconds=120)
    # Nothing that the print depends on.
    same, told = again(strict=True)
    assert stages_of(shop, same) == [] and told["reused"] == "all of it" and told["has_report"]
    assert told["warnings"] == shop.ask("GET", f"/jobs/{first}")["warnings"]
    assert bits(shop.folder / "jobs" / same / "out") == bits(shop.folder / "jobs" / first / "out")
    # What comes after the loop.
    layers, told = again(layers="2-20")
    assert loops_of(shop, layers) == 0 and "layers" in stages_of(shop, layers) and told["reused"] == "what the appearance loop came to"
    assert bits(shop.folder / "jobs" / layers / "out") == console_bits(model, tmp_path / "layers", **quick, layers="2-20")
    # What the loop depends on.
    size, told = again(size="2.5mm")
    assert loops_of(shop, size) == 1 and told["reused"] == ""
    assert bits(shop.folder / "jobs" / size / "out") == console_bits(model, tmp_path / "size", **quick, size="2.5mm")
    # And what was changed is changed again.
    last = shop.ask("POST", "/jobs", {"job": size, "model": "box.glb", "options": {**quick, "size": "2.5mm", "layers": "3-30"}})["id"]
    shop.wait_for(last, "done", seconds=120)
    assert loops_of(shop, last) == 0


def test_a_loop_that_ended_by_itself_is_that_of_best_quality_too(shop, tmp_path):
    model, settles = write_box(tmp_path / "box.glb", (2, 1.2, 1)), {"loop-method": "feedback"}
    good = hand_in(shop, model, options=settles)
    shop.wait_for(good, "done", seconds=120)

    def again(**options):
        job = shop.ask("POST", "/jobs", {"job": good, "model": "box.glb", "options": {**settles, **options}})["id"]
        return job, shop.wait_for(job, "done", seconds=120)["reused"]

    def skin(job):
        return (shop.folder / "jobs" / job / "out/skin.mixtures").read_bytes()
    best, reused = again(quality="best")
    assert loops_of(shop, best) == 0 and reused == "what the appearance loop came to"
    assert bits(shop.folder / "jobs" / best / "out") == console_bits(model, tmp_path / "best", **settles, quality="best")
    first = skin(good)
    shorter, reused = again(iterations=1)  # has to end before
    assert loops_of(shop, shorter) == 1 and reused == "" and skin(shorter) != first and skin(good) == first


def test_parts_of_a_tray_that_stay_keep_their_loops(shop, tmp_path):
    models = [write_box(tmp_path / f"{name}.glb", size) for name, size in (("one", (2, 1.2, 1)), ("two", (1.5, 1.5, 1)))]
    parts = [{"model": model.name, **quick} for model in models]
    first = hand_in(shop, *models, parts=parts)
    shop.wait_for(first, "done", seconds=120)
    assert loops_of(shop, first) == 2
    parts[1]["size"] = "1.6mm"
    changed = shop.ask("POST", "/jobs", {"job": first, "parts": parts})["id"]
    told = shop.wait_for(changed, "done", seconds=120)
    assert loops_of(shop, changed) == 1 and told["reused"] == "what the loops of 1 parts came to"
    fresh = hand_in(shop, *models, parts=parts)
    shop.wait_for(fresh, "done", seconds=120)
    assert bits(shop.folder / "jobs" / changed / "out") == bits(shop.folder / "jobs" / fresh / "out")


def until(what, seconds=30.0):
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end
        time.sleep(0.1)


def test_what_arrives_in_a_folder_is_a_queue_with_a_name(tmp_path):
    hot = tmp_path / "hot"
    hot.mkdir()
    data = write_box(tmp_path / "box.glb").read_bytes()
    (hot / "slow.glb").write_bytes(data[:500])  # is being written
    (hot / "named.obj").write_text("mtllib colours.mtl\nv 0 0 0\nv 5 0 0\nv 0 5 0\nv 0 0 5\nusemtl a\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    (hot / "readme.txt").write_text("no model")
    (tmp_path / "elsewhere.glb").write_bytes(data)
    (hot / "link.glb").symlink_to(tmp_path / "elsewhere.glb")
    shop = Served(tmp_path / "shop", "--watch", f"frames={hot}")
    options = shop.folder / "watch/frames.json"
    options.write_text(json.dumps({"format": "voxtone-job", "version": 1, "quality": "draft", "size": "5mm", "sise": 1}))

    def jobs(name):
        return [job for job in shop.ask("GET", "/jobs")["jobs"] if job["name"] == name]

    def state():
        return shop.ask("GET", "/shop")["watches"][0]
    for _ in range(8):
        time.sleep(0.5)
        with open(hot / "slow.glb", "ab") as file:
            file.write(b"" if file.tell() >= len(data) else data[file.tell():file.tell() + 50])
        assert not jobs("slow.glb")
    (hot / "slow.glb").write_bytes(data)
    until(lambda: jobs("slow.glb"))
    job = jobs("slow.glb")[0]
    assert job["queue"] == "frames" and job["options"] == {"quality": "draft", "size": "5mm"}
    shop.wait_for(job["id"], "done")
    # What a model names is waited for, and what lies outside is not followed.
    assert not jobs("named.obj") and not jobs("link.glb")
    until(lambda: any("named.obj: waits up to" in text for text in state()["said"]))
    (hot / "colours.mtl").write_text("newmtl a\nKd 1 0 0\n")
    until(lambda: jobs("named.obj"))
    assert [file["name"] for file in shop.ask("GET", f"/jobs/{jobs('named.obj')[0]['id']}/files")["files"]] == ["colours.mtl", "named.obj"]
    # A new service takes nothing twice; what was written anew, and only with options that go.
    shop.kill()
    options.write_text("{")
    shop.start()
    (hot / "slow.glb").write_bytes(data + bytes(4))
    until(lambda: "frames.json: the job file is no JSON" in state()["why"])  # it waits to be whole before that
    assert state()["waits"] == 1 and len(jobs("slow.glb")) == 1
    options.write_text(json.dumps({"format": "voxtone-job", "version": 1, "quality": "draft"}))
    until(lambda: len(jobs("slow.glb")) == 2)
    until(lambda: state()["waits"] == 0)
    assert len(jobs("named.obj")) == 1 and not jobs("link.glb") and any("link.glb: is left aside" in text for text in state()["said"])
    assert not list((shop.folder / "uploads").iterdir())
    watcher = Path(f"/proc/{shop.process.pid}/task/{shop.process.pid}/children")
    shop.stop()
    assert not watcher.exists()
    for words, why in ((f"frames={hot}/none", "is no folder"), ("frames", "NAME=FOLDER"), (f"a/b={hot}", "letters"), (f"frames={tmp_path}", "lie in each other")):
        with pytest.raises(RuntimeError, match=why):
            Served(tmp_path / "shop", "--watch", words)


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    """Stand-ins for its commands: one job at a time, in their order, while there is no file `blocked`."""
    place = tmp_path / "slurm"
    (place / "bin").mkdir(parents=True)

    def command(name, text):
        file = place / "bin" / name
        file.write_text(f"#!/bin/sh\ncd {place}\n{text}")
        file.chmod(0o755)
    command("scontrol", "echo 'MaxArraySize            = 1001'\n")
    command("squeue", "cat queue 2>/dev/null || true\n")
    command("scancel", "echo scancel \"$@\" >>said\nfor n; do touch cancelled.$n; sed -i \"/^$n\\$/d\" queue; done\n")
    command("sbatch", """echo sbatch "$@" >>said
n=$(($(cat count 2>/dev/null || echo 0) + 1)); echo $n >count; echo $n >>queue
for script; do :; done
setsid flock lock sh -c "while [ -e blocked ]; do sleep 0.1; done; [ -e cancelled.$n ] || sh $script >>log 2>&1; sed -i '/^$n\\$/d' queue" </dev/null >/dev/null 2>&1 &
echo "$n;cluster"
""")
    monkeypatch.setenv("PATH", f"{place / 'bin'}:{os.environ['PATH']}")
    return place


def test_a_cluster_gets_each_job_once_and_its_state_is_read_back(tmp_path, slurm):
    model = write_box(tmp_path / "box.glb")
    (slurm / "blocked").touch()
    shop = Served(tmp_path / "shop", "--slurm", "--sbatch-option", "partition=long")
    options = {"quality": "draft", "size": "5mm"}
    jobs = [hand_in(shop, model, options=options, name=name) for name in ("kept", "cancelled")]

    def calls():
        return (slurm / "said").read_text().splitlines() if (slurm / "said").exists() else []
    for job in jobs:
        until(lambda job=job: shop.ask("GET", f"/jobs/{job}")["progress"].get("stage") == "waits in Slurm")
    assert sum("whole.sh" in call and "partition=long" in call for call in calls()) == 2
    shop.kill()
    shop.start()  # asks again, and nothing is handed over twice
    for job in jobs:
        until(lambda job=job: shop.ask("GET", f"/jobs/{job}")["progress"].get("stage") == "waits in Slurm")
    assert sum("whole.sh" in call for call in calls()) == 2
    shop.ask("POST", f"/jobs/{jobs[1]}/cancel", {})
    shop.wait_for(jobs[1], "cancelled")
    assert any(call.startswith("scancel") for call in calls())
    assert shop.stop() == 0  # what is in Slurm stays there
    assert len([call for call in calls() if call.startswith("scancel")]) == 1
    (slurm / "blocked").unlink()
    shop.start()
    told = shop.wait_for(jobs[0], "done", seconds=120)
    assert told["has_report"] and told["exit_code"] == 0
    assert bits(shop.folder / "jobs" / jobs[0] / "out") == console_bits(model, tmp_path / "console", **options)
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF" + bytes(100))
    told = shop.wait_for(hand_in(shop, broken), "failed")
    with pytest.raises(voxtone.Error) as console:
        voxtone.slice(broken, out=tmp_path / "out").result()
    assert told["message"].partition("glTF")[2] + " [invalid-input]" == str(console.value).partition("glTF")[2]
    tray = hand_in(shop, model, parts=[{"model": "box.glb", "copies": 2, **options}])
    assert shop.wait_for(tray, "done", seconds=120)["has_stack"]
    shop.stop()


def test_without_slurm_its_service_does_not_begin(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RuntimeError, match="sbatch, squeue, scancel, scontrol not on this machine"):
        Served(tmp_path / "shop", "--slurm")
