# SPDX-License-Identifier: GPL-3.0-or-later
"""The road through `voxtone serve`: handed in, estimated, sliced, fetched; and what survives."""
import io
import json
import os
import random
import shutil
import subprocess
import threading
import time
import urllib.parse
import zipfile

import pytest

import voxtone
from conftest import box
from shops import Served, bits, console_bits, write_box
from voxtone.serve.files import checked_path, write_json
from voxtone.serve.form import basic, decided_here, form
from voxtone.serve.limits import Limits
from voxtone.serve.refusal import Refusal
from voxtone.serve.retention import Retention
from voxtone.serve.store import Store


@pytest.fixture(scope="module")
def shop(tmp_path_factory):
    served = Served(tmp_path_factory.mktemp("served") / "shop")
    yield served
    served.stop()


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return write_box(tmp_path_factory.mktemp("model") / "box.glb")


def hand_in(shop, model, **asked):
    told = shop.ask("POST", "/jobs", {"upload": shop.upload(model), "options": {"quality": "draft"}, **asked})
    return told["id"]


def test_a_file_becomes_a_print_with_the_bits_of_the_console(shop, model, tmp_path):
    job = hand_in(shop, model)
    told = shop.wait_for(job, "done")
    assert told["verdict"]["sentence"] and told["has_report"] and told["exit_code"] == 0
    status, data, headers = shop.request("GET", f"/jobs/{job}/out.zip")
    assert status == 200 and headers["Content-Type"] == "application/zip"
    zipfile.ZipFile(io.BytesIO(data)).extractall(tmp_path / "fetched")
    voxtone.verify(tmp_path / "fetched").result()  # raises where it is not whole
    assert bits(tmp_path / "fetched") == console_bits(model, tmp_path / "console", quality="draft")
    for_printer = zipfile.ZipFile(io.BytesIO(shop.request("GET", f"/jobs/{job}/printer.zip")[1]))
    assert for_printer.testzip() is None and "HOW-TO-PRINT.html" in for_printer.namelist()
    assert shop.request("GET", f"/jobs/{job}/layers/3.png")[1].startswith(b"\x89PNG")
    assert b"Will it look as asked" in shop.request("GET", f"/jobs/{job}/report")[1]


def test_events_are_the_programs_own_and_end(shop, model):
    job = hand_in(shop, model)
    data = shop.request("GET", f"/jobs/{job}/events")[1].decode()
    events = [json.loads(line[6:]) for line in data.split("\n") if line.startswith("data: ")]
    assert events[0]["event"] == "start" and any(event.get("stage") == "layers" for event in events)
    assert events[-1]["state"] == "done" and "event: end" in data


def test_bad_input_gets_the_sentence_of_the_console(shop, model, tmp_path):
    for options in ({"size": "banana"}, {"quality": "fine"}, {"sise": "3mm"}):
        status, data, _ = shop.request("POST", "/jobs", json.dumps({"upload": shop.upload(model), "options": options}).encode(),
                                       {"Content-Type": "application/json"})
        assert 400 <= status < 500
        with pytest.raises((voxtone.UsageError, TypeError)) as console:
            voxtone.slice(model, out=tmp_path / "out", **options).result()
        assert json.loads(data)["error"] == str(console.value)
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF" + bytes(100))
    told = shop.wait_for(hand_in(shop, broken), "failed")
    with pytest.raises(voxtone.Error) as console:
        voxtone.slice(broken, out=tmp_path / "out").result()
    assert told["message"].replace("broken.glb", str(broken)) == str(console.value) or told["message"] == str(console.value)
    assert told["exit_code"] == console.value.exit_code


def test_an_estimate_is_the_consoles(shop, model):
    upload = shop.upload(model)
    told = shop.ask("POST", "/estimate", {"upload": upload, "options": {"size": "5mm"}})["result"]
    console = voxtone.estimate(model, size="5mm", quick=True).result()
    for key in ("size_px", "layers", "ml", "surface_mm2"):
        assert told[key] == console[key]
    full = shop.ask("POST", "/estimate", {"upload": upload, "options": {"size": "5mm"}, "full": True})["result"]
    assert sum(resin["ml"] for resin in full["resins"]) == pytest.approx(full["ml"], rel=1e-3)


def test_what_a_file_holds_is_told_and_shown(shop, model, tmp_path):
    upload = shop.upload(model)
    def look(path, name="box.glb", **options):
        query = f"?name={name}&options={urllib.parse.quote(json.dumps(options))}"
        told = shop.ask("GET", f"{path}/read{query}")
        return told["result"]["files"][0], shop.request("GET", f"{path}/look{query}")
    contents, (status, picture, headers) = look(f"/uploads/{upload}")
    assert contents == {**voxtone.read(model).result()["files"][0], "file": "box.glb"}
    assert (status, headers["Content-Type"]) == (200, "image/png")
    voxtone.read(model, picture=tmp_path / "console.png").result()
    assert picture == (tmp_path / "console.png").read_bytes()
    # As it is read with what was chosen; what reading does not look at changes nothing.
    larger, (_, turned, _) = look(f"/uploads/{upload}", size="12mm", rotate="x90", quality="draft")
    assert larger["size_mm"][0] == pytest.approx(12) and turned != picture
    job = hand_in(shop, model, held=True)
    assert look(f"/jobs/{job}")[1][1] == picture
    shop.ask("DELETE", f"/jobs/{job}")
    # What cannot be read has the console's sentence, and no picture.
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF" + bytes(100))
    with pytest.raises(voxtone.Error) as console:
        voxtone.slice(broken, out=tmp_path / "out").result()
    contents, (status, said, _) = look(f"/uploads/{shop.upload(broken)}", "broken.glb")
    assert status == 404 and json.loads(said)["error"] == contents["error"]
    assert contents["error"] + " [invalid-input]" == str(console.value).replace(str(broken), "broken.glb")
    assert not list((shop.folder / "asking").glob("*/picture.png"))


def test_a_newer_estimate_takes_the_place_of_an_older(shop, model):
    upload = shop.upload(model)
    codes = []

    def ask(size):
        asked = json.dumps({"upload": upload, "options": {"size": size}, "full": True, "who": "me"}).encode()
        codes.append((size, shop.request("POST", "/estimate", asked, {"Content-Type": "application/json"})[0]))
    askers = []
    for at in range(6):
        askers.append(threading.Thread(target=ask, args=(f"{12 + at}mm",)))
        askers[-1].start()
        time.sleep(0.02)
    for asker in askers:
        asker.join()
    told = dict(codes)
    assert told["17mm"] == 200 and set(told.values()) <= {200, 409} and 409 in told.values()


def test_the_queue_is_held_moved_cancelled_and_tried_again(shop, model):
    ids = [hand_in(shop, model, held=True, name=f"job {at}") for at in range(3)]
    def order():
        return [job["id"] for job in shop.ask("GET", "/jobs")["jobs"] if job["id"] in ids]
    assert order() == ids and {shop.ask("GET", f"/jobs/{one}")["state"] for one in ids} == {"held"}
    shop.ask("POST", f"/jobs/{ids[2]}/up", {})
    assert order() == [ids[0], ids[2], ids[1]]
    shop.ask("POST", f"/jobs/{ids[0]}/down", {})
    assert order() == [ids[2], ids[0], ids[1]]
    assert shop.ask("POST", f"/jobs/{ids[0]}/cancel", {})["state"] == "cancelled"
    assert shop.ask("POST", f"/jobs/{ids[0]}/retry", {})["state"] in ("waiting", "running")
    shop.ask("POST", f"/jobs/{ids[1]}/release", {})
    for one in ids[:2]:
        shop.wait_for(one, "done")
    shop.ask("DELETE", f"/jobs/{ids[0]}")
    assert shop.request("GET", f"/jobs/{ids[0]}")[0] == 404
    assert shop.request("POST", f"/jobs/{ids[1]}/hold", b"{}", {"Content-Type": "application/json"})[0] == 409
    shop.ask("POST", f"/jobs/{ids[2]}/cancel", {})


def test_what_runs_is_held_and_goes_on_with_its_loop(shop, tmp_path):
    model = write_box(tmp_path / "larger.glb", (5, 4, 2))
    options = {"iterations": 6, "predict": "none"}
    job = hand_in(shop, model, options=options)
    out = shop.folder / "jobs" / job / "out"
    until = time.monotonic() + 60
    while not (out / "loop.checkpoint").exists():
        assert time.monotonic() < until
        time.sleep(0.02)
    shop.ask("POST", f"/jobs/{job}/hold", {})
    assert shop.wait_for(job, "held", "done")["state"] == "held"
    assert (out / "loop.checkpoint").exists()
    shop.ask("POST", f"/jobs/{job}/release", {})
    told = shop.wait_for(job, "done", seconds=120)
    assert told["tries"] == 2
    assert bits(out) == console_bits(model, tmp_path / "console", **options)


def test_a_cancelled_job_ends_soon_and_leaves_no_stack(shop, tmp_path):
    model = write_box(tmp_path / "larger.glb", (8, 6, 3))
    job = hand_in(shop, model, options={"iterations": 200, "predict": "none"})
    shop.wait_for(job, "running")
    shop.ask("POST", f"/jobs/{job}/cancel", {})
    assert not shop.wait_for(job, "cancelled", seconds=20)["has_stack"]


def test_a_job_is_made_again_from_another_with_other_options(shop, model):
    first = hand_in(shop, model)
    shop.wait_for(first, "done")
    second = shop.ask("POST", "/jobs", {"job": first, "model": "box.glb", "options": {"quality": "draft", "size": "5mm"}})["id"]
    shop.wait_for(second, "done")
    sizes = [shop.ask("GET", f"/jobs/{one}/report.json")["size_mm"][0] for one in (first, second)]
    assert sizes == pytest.approx([6, 5], abs=0.1)


def test_copies_are_jobs_and_one_key_is_one_job(shop, model):
    upload = shop.upload(model)
    asked = {"upload": upload, "options": {"quality": "draft"}, "copies": 3, "held": True}
    first = [job["id"] for job in shop.ask("POST", "/jobs", asked, Idempotency_Key="key-of-the-test")["jobs"]]
    again = [job["id"] for job in shop.ask("POST", "/jobs", asked, Idempotency_Key="key-of-the-test")["jobs"]]
    assert len(set(first)) == 3 and first == again
    for one in first:
        shop.ask("DELETE", f"/jobs/{one}")


def test_a_tray_of_parts(shop, model):
    parts = [{"model": "box.glb", "copies": 2, "at": [[0, 0], [0, 10]]}, {"model": "box.glb", "rotate": "z90", "at": [20, 0]}]
    job = hand_in(shop, model, parts=parts)
    shop.wait_for(job, "done")
    told = shop.ask("GET", f"/jobs/{job}/tray.json")
    assert len(json.dumps(told)) > 100
    assert shop.request("GET", f"/jobs/{job}/tray.png")[1].startswith(b"\x89PNG")
    assert shop.ask("GET", f"/jobs/{job}/manifest.json")["size_mm"][0] > 22


def test_a_job_file_fills_the_form(shop, tmp_path):
    file = tmp_path / "job.json"
    file.write_text(json.dumps({"format": "voxtone-job", "version": 1, "model": "/elsewhere/cow.obj", "size": "60mm", "quality": "good",
                                "out": "/etc", "keep-thin": False}))
    told = shop.ask("GET", f"/uploads/{shop.upload(file)}/job-file?name=job.json")
    assert told["model"] == "cow.obj" and told["options"] == {"size": "60mm", "keep-thin": False}


def test_the_form_is_the_table(shop):
    table = {option.name: option for option in voxtone.option_table()["slice"].options}
    assert decided_here - {"quick", "orientations"} <= set(table)
    told = [option["name"] for group in shop.ask("GET", "/options")["groups"] for option in group["options"]]
    assert sorted(told) == sorted(set(table) - decided_here) and set(basic) <= set(told)
    paths = shop.ask("GET", "/openapi.json")
    assert sorted(paths["components"]["schemas"]["Options"]["properties"]) == sorted(told)
    assert "/jobs/{id}/printer.zip" in paths["paths"]
    assert form()["groups"][0]["options"][0]["help"] == table["formats"].help


def test_from_python_it_has_the_functions_of_the_package(shop, tmp_path):
    there = voxtone.connect(shop.address)
    assert {"stratasys-j750-hm"} <= {printer["id"] for printer in there.printers()} and there.resin_sets() == voxtone.resin_sets()
    events = []
    mesh = box()
    stack = there.slice(mesh, quality="draft", predict="none", out=tmp_path / "fetched", progress=events.append).result(60)
    assert stack.layer(3).shape == voxtone.slice(mesh, quality="draft", predict="none", out=tmp_path / "here").result().layer(3).shape
    assert bits(tmp_path / "fetched") == bits(tmp_path / "here")
    job = there.slice(mesh, quality="draft")
    assert [event["event"] for event in job][0] == "start" and job.result()["format"] == "voxtone-report"
    assert there.estimate(mesh, size="5mm", quick=True)["layers"] == voxtone.estimate(mesh, size="5mm", quick=True).result()["layers"]
    with pytest.raises(voxtone.Error, match="is not a length"):
        there.slice(mesh, size="banana")
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF" + bytes(100))
    with pytest.raises(voxtone.InputError, match="broken.glb"):
        there.slice(broken).result()
    with pytest.raises(voxtone.Error, match="not the one of this shop"):
        voxtone.connect(f"http://127.0.0.1:{shop.port}", "0" * 32)


def test_a_page_without_script_hands_in_shows_and_acts(shop, model):
    text = shop.request("GET", "/plain")[1].decode()
    word = text.partition('name="form" value="')[2].partition('"')[0]
    body = (f"--x\r\nContent-Disposition: form-data; name=\"form\"\r\n\r\n{word}\r\n--x\r\nContent-Disposition: form-data; name=\"file\"; "
            "filename=\"plain.glb\"\r\n\r\n").encode() + model.read_bytes() + (
            b"\r\n--x\r\nContent-Disposition: form-data; name=\"quality\"\r\n\r\ndraft\r\n--x--\r\n")
    origin = {"Origin": f"http://127.0.0.1:{shop.port}", "Content-Type": "multipart/form-data; boundary=x"}
    status, data, headers = shop.request("POST", "/plain", body, origin)
    assert (status, headers["Location"]) == (303, "/plain"), data
    job = next(one for one in shop.ask("GET", "/jobs")["jobs"] if one["name"] == "plain.glb")
    assert job["options"] == {"quality": "draft"}
    shop.wait_for(job["id"], "done")
    assert f"/jobs/{job['id']}/printer.zip" in shop.request("GET", "/plain")[1].decode()
    act = {**origin, "Content-Type": "application/x-www-form-urlencoded"}
    assert shop.request("POST", "/plain", f"act=remove+{job['id']}".encode(), act)[0] == 403
    assert shop.request("GET", f"/jobs/{job['id']}")[0] == 200  # without the word nothing was done
    shop.request("POST", "/plain", f"form={word}&act=remove+{job['id']}".encode(), act)
    assert shop.request("GET", f"/jobs/{job['id']}")[0] == 404


def test_one_folder_has_one_service_and_no_other_things(shop, tmp_path):
    with pytest.raises(RuntimeError, match="another `voxtone serve` works in"):
        Served(shop.folder)
    (tmp_path / "mine.txt").write_text("x")
    with pytest.raises(RuntimeError, match="holds other things"):
        Served(tmp_path)


def test_killed_at_any_moment_nothing_is_lost_and_nothing_is_twice(tmp_path, model):
    """`killed` times at random, every other time with all jobs, as a power cut would."""
    kill_often(tmp_path, model, jobs=3, kills=4)


@pytest.mark.skipif("VOXTONE_LONG" not in os.environ, reason="takes minutes; VOXTONE_LONG=1, as the CTest serve_kills has it")
def test_killed_fifty_times_nothing_is_lost_and_nothing_is_twice(tmp_path, model):
    kill_often(tmp_path, model, jobs=10, kills=50)


def kill_often(tmp_path, model, jobs, kills):
    dice = random.Random(7)
    shop = Served(tmp_path / "shop", "--jobs", "2")
    keys = [f"key-{at:08}" for at in range(jobs)]
    options = {"iterations": 4, "predict": "none"}
    answered, uploads = set(), {}
    killed = 0
    while True:
        until = time.monotonic() + dice.uniform(0.05, 1.5)
        while time.monotonic() < until and len(answered) < jobs:
            key = keys[len(answered)]
            if key not in uploads:
                uploads[key] = shop.upload(model)
            shop.ask("POST", "/jobs", {"upload": uploads[key], "options": {**options, "size": f"{4 + keys.index(key) / 2}mm"}, "name": key},
                     Idempotency_Key=key)
            answered.add(key)
            time.sleep(0.2)
        time.sleep(max(0, until - time.monotonic()))
        if killed == kills:
            break
        shop.kill()
        if killed % 2:
            shop.kill_jobs()
        killed += 1
        shop.start()
    told = shop.ask("GET", "/jobs")["jobs"]
    assert sorted(job["name"] for job in told) == sorted(answered) and len(answered) == jobs
    for job in told:
        shop.wait_for(job["id"], "done", seconds=300)
        at = keys.index(job["name"])
        assert bits(shop.folder / "jobs" / job["id"] / "out") == console_bits(model, tmp_path / f"console{at}", size=f"{4 + at / 2}mm", **options)
    shop.stop()


def test_stopped_it_saves_what_runs_and_goes_on(tmp_path):
    shop = Served(tmp_path / "shop")
    model = write_box(tmp_path / "larger.glb", (4, 3, 2))
    job = hand_in(shop, model, options={"iterations": 6, "predict": "none"})
    shop.wait_for(job, "running")
    assert shop.stop() == 0
    state = json.loads((shop.folder / "jobs" / job / "state.json").read_text())
    assert state["state"] == "waiting" and "goes on" in state["message"]
    shop.start()
    assert shop.wait_for(job, "done", seconds=120)["tries"] == 2
    shop.stop()


def test_a_broken_state_or_half_a_job_takes_nothing_with_it(tmp_path, model):
    shop = Served(tmp_path / "shop")
    kept, broken = hand_in(shop, model), hand_in(shop, model, held=True)
    shop.wait_for(kept, "done")
    shop.kill()
    (shop.folder / "jobs" / broken / "state.json").write_text("{\"state\": ")
    (shop.folder / "jobs" / ("0" * 32)).mkdir()  # begun to be handed in
    shop.start()
    told = {job["id"]: job["state"] for job in shop.ask("GET", "/jobs")["jobs"]}
    assert told[kept] == "done" and set(told) == {kept, broken}
    shop.wait_for(broken, "done")  # what it is stands in job.json
    shop.stop()


def test_a_full_disk_stops_the_queue_with_a_word(tmp_path, model, monkeypatch):
    from voxtone.serve import limits, runner
    from voxtone.serve.shop import Shop
    shop = Shop(tmp_path / "shop", Limits())
    told = []
    shop.runner.tell_shop = lambda: told.append(shop.runner.paused)
    shop.begin()
    upload = shop.uploads.begin()
    shop.uploads.add(upload, "box.glb", 0, lambda out: out.write(model.read_bytes()))
    monkeypatch.setattr(runner, "free_bytes", lambda folder: 1000)
    job = shop.hand_in({"upload": upload, "options": {"quality": "draft"}})[0]
    time.sleep(0.5)
    assert job.state.state == "waiting" and "The disk is full: 1000 bytes are left" in told[0]
    monkeypatch.setattr(limits, "free_bytes", lambda folder: 1000)
    with pytest.raises(Refusal, match="are not taken") as refusal:
        shop.uploads.add(upload, "more.glb", 0, lambda out: None)
    assert refusal.value.status == 507
    monkeypatch.undo()
    shop.runner.wake()
    until = time.monotonic() + 30
    while job.state.state != "done":
        assert time.monotonic() < until
        time.sleep(0.05)
    assert told[-1] == ""
    shop.stop()


def test_what_goes_by_age_or_size_says_so_a_day_before(tmp_path):
    store = Store(tmp_path / "jobs", Limits(), lambda job: None)
    (tmp_path / "source").mkdir()
    (tmp_path / "source" / "x.glb").write_text("x")
    day, now = 86400, time.time()
    jobs = [store.add({"name": str(age), "verb": "slice", "model": "x.glb", "options": {}}, tmp_path / "source") for age in range(5)]
    for age, job in enumerate(jobs):
        store.change(job, state="done", ended=now - age * day, bytes=100)
    store.change(jobs[4], kept=True)
    retention = Retention(store, 2, 0)
    retention.look(now)
    assert [bool(job.state.leaves) for job in jobs] == [False, False, True, True, False]
    retention.look(now + day - 60)
    assert len(store.all()) == 5
    retention.look(now + day + 60)
    assert {job.what["name"] for job in store.all()} == {"0", "1", "4"}
    Retention(store, 0, 250).look(now)
    assert [bool(job.state.leaves) for job in jobs[:2]] == [False, True]


def test_names_stay_in_their_folder():
    for name in ("a.obj", "textures/ä b'\"<>&.png", "x" * 200):
        assert checked_path(name) == name
    for name in ("", "/a", "../a", "a/../b", "a//b", "a/", ".a", "a/.b", "a\\b", "a\nb", "a\0b", "x" * 201, "/".join("a" * 20), "..", "\ud800"):
        with pytest.raises(Refusal):
            checked_path(name)


def test_files_are_whole_or_not_there(tmp_path):
    write_json(tmp_path / "a.json", {"one": 1})
    with pytest.raises(TypeError):
        write_json(tmp_path / "a.json", {"one": object()})
    assert json.loads((tmp_path / "a.json").read_text()) == {"one": 1}
