# SPDX-License-Identifier: GPL-3.0-or-later
"""The page in a real browser. With VOXTONE_PICTURES=FOLDER it leaves pictures of its states there, to look at."""
import json
import os
import subprocess
import time
from pathlib import Path

import pytest
from PIL import Image

from browser import Browser, chromium
from shops import Served, bits, write_box
from voxtone.program import program as voxtone_program

pytestmark = pytest.mark.skipif(not chromium(), reason="there is no Chromium here (Debian: chromium)")
pictures = os.environ.get("VOXTONE_PICTURES")


@pytest.fixture(scope="module")
def browser():
    made = Browser()
    yield made
    made.close()


@pytest.fixture
def shop(tmp_path, browser):
    served = Served(tmp_path / "shop")
    browser.set_size(1200, 900)
    browser.open(served.address)
    browser.errors.clear()  # of the page before, whose service is gone
    browser.wait("document.getElementById('empty').hidden === false || document.querySelector('#jobs li')")
    yield served
    served.stop()


def shoot(browser, name):
    if pictures:
        time.sleep(0.3)
        browser.picture(Path(pictures) / f"{name}.png")


def faults(browser):
    """Of the page. That a banana is refused, and an older question overtaken, the browser tells as well."""
    return [told for told in browser.errors if "status of 422" not in told and "status of 409" not in told]


def set_option(browser, name, value):
    browser.evaluate(f"""(() => {{
        const field = [...document.querySelectorAll('.group .field')].find((one) => one.querySelector('label').textContent.trim() === {json.dumps(name)});
        const input = field.querySelector('input, select');
        input.value = {json.dumps(value)};
        input.dispatchEvent(new Event(input.tagName === 'SELECT' ? 'change' : 'input', {{bubbles: true}}));
    }})()""")


def click(browser, text, inside="body"):
    browser.wait(f"[...document.querySelectorAll('{inside} button, {inside} a')].some((one) => one.innerText === {json.dumps(text)})")
    browser.evaluate(f"[...document.querySelectorAll('{inside} button, {inside} a')].find((one) => one.innerText === {json.dumps(text)}).click()")


def test_dropped_estimated_sliced_and_looked_at(shop, browser, tmp_path):
    shoot(browser, "empty")
    model = write_box(tmp_path / "box.glb")
    browser.choose_files("#choose", [str(model)])
    browser.wait("document.querySelector('.models')?.innerText.includes('6.00 × 3.00 × 1.50 mm')")
    browser.wait("document.querySelector('.models img')?.naturalWidth > 300")
    assert browser.evaluate("document.querySelector('.models').innerText").count("colour: vertices") == 1
    seen = browser.evaluate("document.querySelector('.models img').src")
    set_option(browser, "rotate", "x90")
    browser.wait(f"document.querySelector('.models img').src !== '{seen}' && document.querySelector('.models img').naturalWidth > 300")
    set_option(browser, "rotate", "")
    set_option(browser, "size", "5mm")
    browser.wait("document.querySelector('.models').innerText.includes('5.00 × 2.50 × 1.25 mm')")
    assert browser.evaluate("document.querySelector('.field.changed label').innerText") == "size"
    set_option(browser, "size", "banana")
    browser.wait("document.querySelector('.models .failed')?.innerText.includes('not a length')")
    set_option(browser, "size", "5mm")
    set_option(browser, "quality", "draft")
    assert browser.evaluate("document.querySelector('.group code').textContent") == "voxtone slice box.glb --size=5mm --quality=draft -o out/box"
    browser.wait("document.querySelector('.models').innerText.includes('5.00 × 2.50 × 1.25 mm')")
    shoot(browser, "chosen")
    click(browser, "Slice")
    browser.wait("document.querySelector('#jobs .state.done')")
    assert not browser.evaluate("document.querySelector('.group')")
    browser.evaluate("document.querySelector('#jobs .name').click()")
    browser.wait("document.querySelector('#result iframe')")
    time.sleep(1)
    shoot(browser, "done")
    click(browser, "change and slice again", "#result")
    browser.wait("document.querySelector('.group .models')?.innerText.includes('5.00 × 2.50')")
    assert faults(browser) == []
    assert shop.ask("GET", "/jobs")["jobs"][0]["options"] == {"size": "5mm", "quality": "draft"}


def test_what_a_model_names_is_added_and_pictures_beside_it_can_be_meant(shop, browser, tmp_path):
    (tmp_path / "named.obj").write_text("mtllib colours.mtl\nv 0 0 0\nv 5 0 0\nv 0 5 0\nv 0 0 5\nusemtl a\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    (tmp_path / "colours.mtl").write_text("newmtl a\nKd 1 0 0\n")
    Image.new("RGB", (40, 30), "red").save(tmp_path / "beside.png", dpi=(300, 300))
    browser.choose_files("#choose", [str(tmp_path / name) for name in ("named.obj", "beside.png")])
    browser.wait("document.querySelector('.models')?.innerText.includes('LOST')")
    browser.choose_files(".group .acts input[type=file]", [str(tmp_path / "colours.mtl")])
    browser.wait("!document.querySelector('.models').innerText.includes('LOST') && document.querySelector('.models').innerText.includes('colour: materials')")
    click(browser, "print beside.png")
    browser.wait("document.querySelectorAll('.group').length === 2 && document.querySelector('.models').innerText.includes('3.39 × 2.54 × 4.00 mm')")
    assert not browser.evaluate("[...document.querySelectorAll('button')].some((one) => one.innerText === 'print beside.png')")


def test_two_browsers_see_the_same_and_one_that_comes_back(shop, browser, tmp_path):
    """What others do is seen at once; after a restart of the service the page looks again by itself."""
    upload = shop.upload(write_box(tmp_path / "box.glb"))
    job = shop.ask("POST", "/jobs", {"upload": upload, "options": {"quality": "draft"}, "name": "from elsewhere", "held": True})["id"]
    browser.wait("document.querySelector('#jobs .state.held')")
    shop.kill()
    browser.wait("!document.getElementById('alert').hidden")
    shop.start()
    shop.ask("POST", f"/jobs/{job}/release", {})
    browser.wait("document.querySelector('#jobs .state.done')", 30)
    shop.ask("DELETE", f"/jobs/{job}")
    browser.wait("!document.querySelector('#jobs li')")


def test_names_and_messages_are_texts(shop, browser, tmp_path):
    upload = shop.upload(write_box(tmp_path / "box.glb"))
    name = "<img src=x onerror=document.title='taken'>"
    shop.ask("POST", "/jobs", {"upload": upload, "name": name, "held": True})
    browser.wait("document.querySelector('#jobs li')")
    browser.evaluate("document.querySelector('#jobs .name').click()")
    assert browser.evaluate("document.querySelector('#jobs .name').innerText") == name
    assert browser.evaluate("document.getElementById('result-title').innerText") == name
    assert browser.evaluate("document.title") == "voxtone" and not browser.evaluate("document.querySelector('#jobs img')")


def test_a_tray_is_arranged_dragged_and_sliced(shop, browser, tmp_path):
    models = [write_box(tmp_path / f"{name}.glb", size) for name, size in (("one", (6, 3, 1.5)), ("two", (4, 4, 2)))]
    browser.choose_files("#choose", [str(model) for model in models])
    browser.wait("document.querySelectorAll('.models li p:not(.soft)').length >= 4")
    assert browser.evaluate("document.querySelector('.group code').textContent") == "voxtone slice one.glb -o out/one\nvoxtone slice two.glb -o out/two"
    set_option(browser, "quality", "draft")
    click(browser, "Arrange as one tray")
    click(browser, "one more two.glb")
    browser.wait("document.querySelectorAll('svg.plate g').length === 3 && !document.querySelector('svg.plate .overlap')")
    browser.evaluate("document.querySelector('svg.plate').scrollIntoView({block: 'center'})")
    where = browser.evaluate("(() => { const box = document.querySelectorAll('svg.plate g')[0].getBoundingClientRect(); const other = "
                             "document.querySelectorAll('svg.plate g')[1].getBoundingClientRect(); return [box.x + 1, box.y + 1, other.x + 1, other.y + 1]; })()")
    browser.call("Input.dispatchMouseEvent", type="mousePressed", x=where[0], y=where[1], button="left", clickCount=1)
    browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=where[2], y=where[3], button="left")
    browser.wait("document.querySelectorAll('svg.plate .overlap').length >= 2")
    shoot(browser, "overlap")
    browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=where[0], y=where[1], button="left")
    browser.call("Input.dispatchMouseEvent", type="mouseReleased", x=where[0], y=where[1], button="left", clickCount=1)
    browser.wait("!document.querySelector('svg.plate .overlap')")
    browser.evaluate("document.querySelectorAll('svg.plate g')[0].focus()")
    browser.press("r", "r")
    browser.evaluate("document.querySelectorAll('svg.plate g')[0].dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowUp', shiftKey: true}))")
    shoot(browser, "tray")
    console = browser.evaluate("document.querySelector('.group code').textContent").replace("\nvoxtone", f" && {voxtone_program()}")
    click(browser, "Slice the tray")
    browser.wait("document.querySelector('#jobs .state.done')", 60)
    job = shop.ask("GET", "/jobs")["jobs"][0]
    assert sum(part["copies"] for part in job["parts"]) == 3 and any(part.get("rotate") == "z90" for part in job["parts"]) and job["name"] == "tray of 3"
    subprocess.run(console, shell=True, check=True, cwd=tmp_path, capture_output=True)
    assert bits(tmp_path / "out/tray") == bits(shop.folder / "jobs" / job["id"] / "out")
    assert faults(browser) == []


def test_two_results_are_looked_at_from_one_side(shop, browser, tmp_path):
    upload = shop.upload(write_box(tmp_path / "box.glb"))
    jobs = [shop.ask("POST", "/jobs", {"upload": upload, "options": {"quality": "draft", "size": size}})["id"] for size in ("6mm", "8mm")]
    for job in jobs:
        shop.wait_for(job, "done")
    browser.wait("document.querySelectorAll('#jobs .state.done').length === 2")
    browser.evaluate("document.querySelector('#jobs .name').click()")
    browser.evaluate("(() => { const beside = document.querySelector('#result select'); beside.value = beside.options[1].value; "
                     "beside.dispatchEvent(new Event('change')); })()")
    browser.wait("document.querySelectorAll('#result iframe').length === 2")
    browser.evaluate("""window.told = []; addEventListener('message', (event) => { if (event.data.voxtoneView) told.push(
        [[...document.querySelectorAll('#result iframe')].findIndex((frame) => frame.contentWindow === event.source), event.data.voxtoneView]); })""")
    browser.evaluate("document.querySelector('#result .reports').scrollIntoView()")
    time.sleep(4)
    browser.evaluate("told.length = 0")

    def drag(frame, by):
        """The view of that frame after it."""
        x, y = browser.evaluate(f"(() => {{ const box = document.querySelectorAll('#result iframe')[{frame}].getBoundingClientRect(); "
                                "return [box.x + box.width / 4, box.y + box.height * 0.8]; })()")
        browser.evaluate("told.length = 0")
        for kind, to in (("mousePressed", 0), ("mouseMoved", by / 2), ("mouseMoved", by), ("mouseReleased", by)):
            browser.call("Input.dispatchMouseEvent", type=kind, x=x + to, y=y, button="left", buttons=1, clickCount=1)
        browser.wait("told.length > 1")
        time.sleep(0.5)
        assert browser.evaluate(f"told.every(([who]) => who === {frame})")  # the other follows, and does not lead in turn
        return browser.evaluate("told[told.length - 1][1]")
    begin = drag(0, 2)
    turned = drag(0, 80)
    assert 20 < abs(turned["yaw"] - begin["yaw"]) % 360 < 340
    followed = drag(1, 2)  # from where the first has led it
    assert abs(followed["yaw"] - turned["yaw"]) < 2 and followed["pitch"] == turned["pitch"] and abs(followed["zoom"] / turned["zoom"] - 1) < 1e-6
    shoot(browser, "compared")


def test_forty_jobs_one_of_them_failed_one_with_a_long_name_also_on_a_phone_and_in_the_dark(shop, browser, tmp_path):
    upload = shop.upload(write_box(tmp_path / "box.glb"))
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF" + bytes(100))
    shop.wait_for(shop.ask("POST", "/jobs", {"upload": shop.upload(broken)})["id"], "failed")
    shop.wait_for(shop.ask("POST", "/jobs", {"upload": upload, "options": {"quality": "draft"}})["id"], "done")
    shop.ask("POST", "/jobs", {"upload": upload, "held": True, "copies": 37})
    long_name = "Ein_sehr_langer_Name_ohne_jede_Luecke_"
    shop.ask("POST", "/jobs", {"upload": upload, "held": True, "name": long_name * 6})
    browser.choose_files("#choose", [str(write_box(tmp_path / f"{name}.glb")) for name in (long_name * 3, "short")])
    click(browser, "Arrange as one tray")
    browser.wait("document.querySelectorAll('svg.plate g').length === 2")
    browser.wait("document.querySelectorAll('#jobs li').length === 40")
    for width, dark in ((1200, False), (400, False), (400, True), (1200, True)):
        browser.set_size(width, 900, dark)
        assert browser.evaluate("document.documentElement.scrollWidth") <= width
        shoot(browser, f"forty-{width}-{'dark' if dark else 'light'}")
    assert faults(browser) == []


def test_all_of_it_by_keyboard(shop, browser, tmp_path):
    upload = shop.upload(write_box(tmp_path / "box.glb"))
    shop.ask("POST", "/jobs", {"upload": upload, "held": True, "options": {"quality": "draft"}})
    browser.wait("document.querySelector('#jobs li')")
    reached = []
    for _ in range(12):
        browser.press("Tab")
        reached.append(browser.evaluate("document.activeElement.getAttribute('aria-label') || document.activeElement.innerText || document.activeElement.id"))
    for wanted in ("choose", "choose-folder", "box.glb", "release: box.glb", "cancel: box.glb"):
        assert wanted in reached, (wanted, reached)
    unnamed = browser.evaluate("[...document.querySelectorAll('button, a, input, select, iframe')].filter((one) => !(one.innerText || one.title || "
                               "one.getAttribute('aria-label') || one.labels?.length)).length")
    assert unnamed == 0
    browser.evaluate("document.querySelector('#jobs button[aria-label^=release]').focus()")
    browser.press("Enter", "\r")
    browser.wait("document.querySelector('#jobs .state.done')", 60)
    assert browser.evaluate("document.getElementById('jobs').contains(document.activeElement)")  # its buttons are others now


def test_who_works_elsewhere_on_the_page_stays_there(shop, browser, tmp_path):
    upload = shop.upload(write_box(tmp_path / "box.glb"))
    job = shop.ask("POST", "/jobs", {"upload": upload, "held": True, "options": {"quality": "draft"}})["id"]
    browser.wait("document.querySelector('#jobs li')")
    browser.evaluate("document.querySelector('#jobs .name').click()")
    browser.evaluate("document.getElementById('choose').focus(); scrollTo(0, 0)")
    shop.ask("POST", f"/jobs/{job}/release", {})
    browser.wait("document.querySelector('#result iframe')", 60)
    assert browser.evaluate("[document.activeElement.id, scrollY]") == ["choose", 0]
    # What is shown follows what others do, and reports stay as they are looked at.
    browser.evaluate("document.querySelector('#result iframe').seen = true")
    for act, offered in (("keep", "may go by age"), ("unkeep", "keep")):
        shop.ask("POST", f"/jobs/{job}/{act}", {})
        browser.wait(f"[...document.querySelectorAll('#result button')].some((one) => one.innerText === '{offered}')")
    assert browser.evaluate("document.querySelector('#result iframe').seen")


def test_two_hundred_jobs_are_there(shop, browser, tmp_path):
    upload = shop.upload(write_box(tmp_path / "box.glb"))
    shop.ask("POST", "/jobs", {"upload": upload, "held": True, "copies": 200})
    begin = time.monotonic()
    browser.open(f"http://127.0.0.1:{shop.port}/")
    browser.wait("document.querySelectorAll('#jobs li').length === 200")
    print(f"200 jobs: {time.monotonic() - begin:.2f} s")


def test_an_evening_of_a_bureau(shop, browser, tmp_path):
    """Twelve files, one broken, one changed at the last minute, four of them one tray, and the power goes."""
    models = [write_box(tmp_path / f"order-{at:02}.glb", (4 + at % 4, 3, 1.5)) for at in range(11)]
    broken = tmp_path / "order-11.glb"
    broken.write_bytes(b"glTF" + bytes(100))
    browser.choose_files("#choose", [str(file) for file in (*models[:7], broken)])
    browser.wait("document.querySelectorAll('.models > li').length === 8 && document.querySelectorAll('.models .failed').length === 1", 60)
    set_option(browser, "quality", "draft")
    browser.evaluate("document.querySelector('[title=\"options of its own for order-03.glb\"]').click()")
    browser.wait("document.querySelectorAll('.group').length === 2")
    set_option(browser, "size", "5mm")  # of the newest group
    browser.wait("document.querySelector('.models').innerText.includes('5.00 ×')")
    shoot(browser, "evening-chosen")
    click(browser, "Slice")
    browser.wait("document.querySelectorAll('.group').length === 1")
    click(browser, "Slice")
    browser.wait("document.querySelectorAll('#jobs li').length === 8", 60)
    browser.choose_files("#choose", [str(file) for file in models[7:]])
    browser.wait("document.querySelectorAll('.models > li').length === 4 && !document.querySelector('.models .failed')")
    browser.wait("[...document.querySelectorAll('.models > li')].every((one) => one.innerText.includes('layers of'))", 60)
    set_option(browser, "quality", "draft")
    click(browser, "Arrange as one tray")
    click(browser, "Slice the tray")
    browser.wait("document.querySelectorAll('#jobs li').length === 9")
    last = next(job for job in shop.ask("GET", "/jobs")["jobs"] if job["name"] == "order-06.glb")
    shop.kill()
    shop.kill_jobs()
    shop.start()
    if shop.ask("GET", f"/jobs/{last['id']}")["state"] == "waiting":  # changed at the last minute
        shop.ask("POST", f"/jobs/{last['id']}/cancel", {})
    changed = shop.ask("POST", "/jobs", {"job": last["id"], "model": "order-06.glb", "options": {"quality": "draft", "size": "4.5mm"}})["id"]
    shop.wait_for(changed, "done", seconds=120)
    browser.wait("document.querySelectorAll('#jobs .state.running, #jobs .state.waiting').length === 0", 60)
    shoot(browser, "evening-done")
    told = {job["name"]: job for job in shop.ask("GET", "/jobs")["jobs"] if job["state"] != "cancelled"}
    assert sorted(name for name, job in told.items() if job["state"] == "failed") == ["order-11.glb"]
    assert len(told) >= 9 and told["tray of 4"]["has_stack"] and told["order-03.glb"]["options"]["size"] == "5mm"
    for job in told.values():
        assert job["state"] == "failed" or shop.request("GET", f"/jobs/{job['id']}/printer.zip")[0] == 200
