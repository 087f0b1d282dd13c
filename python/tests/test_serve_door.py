# SPDX-License-Identifier: GPL-3.0-or-later
"""Nobody else gets in, and who is in stays in his job's folder."""
import json
import os
import re
import socket
import threading
import time

import pytest

import hostile
from shops import Served, voxtone_walls, write_box
from voxtone.serve import process
from voxtone.serve.limits import Limits


@pytest.fixture(scope="module")
def shop(tmp_path_factory):
    assert Limits().head_s <= 15 and Limits().silence_s <= 20  # which tests need not wait for
    served = Served(tmp_path_factory.mktemp("guarded") / "shop", limits={"head_s": 3, "silence_s": 4})
    yield served
    served.stop()


@pytest.fixture(scope="module")
def upload(shop, tmp_path_factory):
    return shop.upload(write_box(tmp_path_factory.mktemp("model") / "box.glb"))


@pytest.fixture(scope="module")
def job(shop, upload):
    told = shop.ask("POST", "/jobs", {"upload": upload, "options": {"quality": "draft"}})["id"]
    shop.wait_for(told, "done")
    return told


def cookie_of(shop):
    status, _, headers = shop.request("GET", f"/?token={shop.token}", token=False)
    assert status == 303 and headers["Location"] == "/"
    return headers["Set-Cookie"]


def tree(folder):
    return sorted(os.path.relpath(os.path.join(below, name), folder) for below, folders, names in os.walk(folder) for name in names + folders)


def test_every_hostile_request_is_refused_and_changes_nothing(shop, upload, job):
    cookie = cookie_of(shop).partition("=")[2].partition(";")[0]
    before, outside = tree(shop.folder / "jobs"), tree(shop.folder.parent)
    listed = list(hostile.requests(shop.port, shop.token, cookie, job, upload))
    assert len({one.data for one in listed}) >= 500
    answers, threads, slots = {}, [], threading.Semaphore(16)

    def send(at):
        with slots:
            answers[at] = shop.raw(listed[at].data)
    for at in range(len(listed)):
        threads.append(threading.Thread(target=send, args=(at,)))
        threads[-1].start()
    for thread in threads:
        thread.join()
    faults = []
    for at, one in enumerate(listed):
        answer = answers[at]
        status = re.match(rb"HTTP/1\.[01] (\d{3}) ", answer)
        if one.name == "more than said":
            assert answer.count(b"HTTP/1.1") == 1
        if not status or not 400 <= int(status[1]) < 500:
            faults.append((one.name, answer[:200]))
        if any(word in answer for word in (b"Traceback", b"root:", shop.token.encode(), str(shop.folder).encode(), b".py")):
            faults.append((one.name, "leaks", answer[:400]))
    assert not faults, (len(faults), [fault[:2] for fault in faults])
    assert tree(shop.folder / "jobs") == before and shop.ask("GET", f"/jobs/{job}")["state"] == "done"
    made = set(tree(shop.folder.parent)) - set(outside)
    assert all(name.startswith("shop/") for name in made)
    assert not any("half" in name or "passwd" in name for name in made)
    assert not os.path.exists("/tmp/evil")


def test_the_cookie_is_for_this_page_alone(shop):
    said = cookie_of(shop)
    assert "HttpOnly" in said and "SameSite=Strict" in said and shop.token not in said
    assert re.fullmatch("[0-9a-f]{32}", shop.token)
    assert oct((shop.folder / "token").stat().st_mode & 0o777) == "0o600"
    headers = {"Cookie": said.partition(";")[0]}
    assert shop.request("GET", "/jobs", headers=headers, token=False)[0] == 200
    own = {**headers, "Origin": f"http://127.0.0.1:{shop.port}", "Content-Type": "application/json"}
    assert shop.request("POST", "/jobs", b"{}", own, token=False)[0] == 400  # got in, and asked for nothing


def test_pages_run_no_script_of_others(shop, job):
    for path, policy in (("/", "script-src 'self'"), (f"/jobs/{job}/report", "sandbox allow-scripts; default-src 'none'"), ("/jobs", "default-src 'none'")):
        headers = shop.request("GET", path)[2]
        assert policy in headers["Content-Security-Policy"] and headers["X-Content-Type-Options"] == "nosniff"
        assert "Access-Control-Allow-Origin" not in headers
    assert "unsafe" not in shop.request("GET", "/")[2]["Content-Security-Policy"]
    page = shop.request("GET", "/")[1].decode()
    assert not re.search(r"<script(?![^>]*src=)|\son\w+=|style=|https?://", page)


def test_names_are_shown_and_never_markup(shop, job, upload):
    name = "<img src=x onerror=alert(1)>.glb"
    told = shop.ask("POST", "/jobs", {"job": job, "model": "box.glb", "name": name, "held": True})["id"]
    page = shop.request("GET", "/plain")[1].decode()
    assert name not in page and "&lt;img src=x onerror=alert(1)&gt;.glb" in page
    shop.ask("DELETE", f"/jobs/{told}")


def test_slow_clients_hold_nobody_up(tmp_path):
    """No clock tells: these would have an hour, and who asks beside them is answered."""
    shop = Served(tmp_path / "shop", limits={"head_s": 3600})
    slow = [socket.create_connection(("127.0.0.1", shop.port)) for _ in range(Limits().connections + 20)]
    for one in slow:
        try:
            one.sendall(b"GET /jobs HTTP/1.1\r\nHost: ")
        except ConnectionError:
            pass  # gone to make room
    for _ in range(3):
        assert shop.request("GET", "/jobs")[0] == 200
    for one in slow:
        one.close()
    assert shop.stop() == 0


def test_a_byte_now_and_then_does_not_keep_a_place(shop):
    slow = socket.create_connection(("127.0.0.1", shop.port))
    slow.sendall(b"GET /jobs HTTP/1.1\r\nHost: ")
    ended = False
    for _ in range(240):  # two minutes, of the three seconds that it is given
        try:
            slow.sendall(b"x")
            time.sleep(0.5)
        except OSError:
            ended = True
            break
    slow.close()
    assert ended


def test_who_does_not_read_holds_nobody_up(shop, job):
    deaf = [socket.create_connection(("127.0.0.1", shop.port)) for _ in range(20)]
    for one in deaf:
        one.sendall(f"GET /jobs/{job}/out.zip HTTP/1.1\r\nHost: 127.0.0.1:{shop.port}\r\nAuthorization: Bearer {shop.token}\r\n\r\n".encode())
    assert shop.request("GET", "/jobs")[0] == 200
    for one in deaf:
        one.close()


@pytest.mark.skipif(voxtone_walls().landlock_version() < 2, reason="the kernel has no Landlock")
def test_a_job_sees_no_file_of_another(shop, tmp_path, upload):
    """Whatever a file that is handed in names."""
    secret = shop.folder.parent / "secret"
    secret.mkdir(exist_ok=True)
    write_box(secret / "other.glb")
    model = tmp_path / "box.obj"
    model.write_text("mtllib ../../../../secret/x.mtl\nv 0 0 0\nv 5 0 0\nv 0 5 0\nv 0 0 5\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    (secret / "x.mtl").write_text("newmtl a\nKd 1 0 0\n")
    told = shop.ask("POST", "/jobs", {"upload": shop.upload(model), "options": {"quality": "draft"}})["id"]
    done = shop.wait_for(told, "done", "failed")
    assert not any("read" in text and "x.mtl" in text and "lost" not in text for text in done["warnings"])
    out, said = open(tmp_path / "out", "wb"), open(tmp_path / "said", "wb")
    work = tmp_path / "work"
    work.mkdir()
    for words in (["slice", "--quality=draft", f"--out={work}/out", "--", str(secret / "other.glb")],
                  ["slice", "--quality=draft", f"--out={secret}/out", "--", str(shop.uploads_of(upload))]):
        assert process.start(words, work, [shop.folder / "uploads" / upload], work, out, said).wait(180) in (3, 4)
    assert not (secret / "out").exists()
    good = ["slice", "--quality=draft", f"--out={work}/out", "--", str(shop.uploads_of(upload))]
    assert process.start(good, work, [shop.folder / "uploads" / upload], work, out, said).wait(180) == 0


def test_limits_say_what_to_do(shop, tmp_path):
    from voxtone.serve.refusal import Refusal
    from voxtone.serve.store import Store
    from voxtone.serve.upload import Uploads
    uploads = Uploads(tmp_path / "uploads", Limits(uploads=2, upload_files=2, file_bytes=100, upload_bytes=150))
    one = uploads.begin()
    uploads.begin()
    with pytest.raises(Refusal, match="wait to be used already"):
        uploads.begin()
    write = lambda out: out.write(b"x" * 90)
    uploads.add(one, "a.obj", 90, write)
    for size, name, words in ((101, "b.obj", "files of up to 100 bytes"), (90, "b.obj", "an upload has 150 bytes at most"), (1, "a.obj/b", "a file and a folder")):
        with pytest.raises(Refusal, match=words):
            uploads.add(one, name, size, write)
    uploads.add(one, "c.obj", 5, lambda out: out.write(b"x"))
    with pytest.raises(Refusal, match="2 files at most"):
        uploads.add(one, "d.obj", 5, write)
    store = Store(tmp_path / "jobs", Limits(jobs=1), lambda job: None)
    store.add({"name": "a", "verb": "slice", "options": {}}, tmp_path / "uploads" / one)
    with pytest.raises(Refusal, match="1 jobs are here"):
        store.add({"name": "b", "verb": "slice", "options": {}}, tmp_path / "uploads" / one)
    assert json.dumps(tree(tmp_path / "jobs")).count("job.json") == 1


def test_others_names_are_let_in_where_they_are_named(tmp_path):
    shop = Served(tmp_path / "shop", "--host", "print.example")
    assert shop.request("GET", "/jobs", headers={"Host": "print.example"})[0] == 200
    assert shop.request("GET", "/jobs", headers={"Host": "print.example.evil"})[0] == 421
    assert shop.stop() == 0
