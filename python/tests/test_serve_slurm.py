# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs of the service on a real Slurm, of which something ends on the way."""
import shutil
import tempfile
import time
from pathlib import Path

import pytest

import one_node_slurm
from one_node_slurm import OneNodeSlurm, ask, until
from shops import Served, bits, console_bits, write_box

pytestmark = pytest.mark.skipif(bool(one_node_slurm.what_is_missing()), reason=one_node_slurm.what_is_missing())
draft = {"quality": "draft", "size": "5mm"}
loop = {"size": "5mm", "iterations": 16, "viewing-distance": 200, "predict": "none"}


@pytest.fixture
def slurm():
    folder = Path(tempfile.mkdtemp(prefix="slurm"))  # for names of sockets are short
    made = OneNodeSlurm(folder)
    yield made
    made.close()
    shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture
def shop(tmp_path, slurm):
    served = Served(tmp_path / "shop", "--slurm")
    yield served
    served.stop()


def hand_in(shop, *files, **asked):
    return shop.ask("POST", "/jobs", {"upload": shop.upload(*files), **asked})["id"]


def wait_for_stage(shop, job, text):
    until(lambda: text in str(shop.ask("GET", f"/jobs/{job}")["progress"].get("stage")))


def wait_for_loop(shop, job):
    until((shop.folder / "jobs" / job / "cluster/out/loop.checkpoint").exists)


def act(shop, what, *jobs):
    for job in jobs:
        shop.ask("POST", f"/jobs/{job}/{what}", {})


def test_jobs_are_done_while_the_service_the_node_and_the_controller_come_and_go(tmp_path, slurm, shop):
    box, broken = write_box(tmp_path / "box.glb"), tmp_path / "broken.glb"
    broken.write_bytes(b"glTF" + bytes(100))
    ask("scontrol", "update", "partitionname=main", "state=down")
    jobs = [hand_in(shop, box, options=options) for options in (loop, draft)]
    for job in jobs:
        wait_for_stage(shop, job, "waits in Slurm (PartitionDown)")
    shop.kill()
    ask("scontrol", "update", "partitionname=main", "state=up")
    slurm.kill("slurmctld")
    shop.start()  # Slurm does not answer: what is there stays, what is new waits
    told = hand_in(shop, box, options={**draft, "size": "4mm"})
    until(lambda: "Slurm does not answer" in shop.ask("GET", f"/jobs/{told}")["message"])
    slurm.start_controller()
    jobs.append(told)
    wait_for_loop(shop, jobs[0])
    slurm.kill("slurmd")
    slurm.start_node()
    failed = shop.wait_for(hand_in(shop, broken), "failed", seconds=120)
    assert "no valid glTF file" in failed["message"] and failed["exit_code"] == 3
    for job in jobs:
        shop.wait_for(job, "done", seconds=240)
    assert bits(shop.folder / "jobs" / jobs[0] / "out") == console_bits(box, tmp_path / "console", **loop)
    shop.ask("DELETE", f"/jobs/{jobs[1]}")
    until(lambda: not one_node_slurm.queue())
    assert ask("scontrol", "--oneliner", "show", "jobs").count("JobName=out:whole") == 3  # nothing twice; the broken one was refused before


def test_what_is_cancelled_or_held_leaves_slurm_and_goes_on_when_it_is_asked_to(tmp_path, slurm, shop):
    box = write_box(tmp_path / "box.glb")
    jobs = [hand_in(shop, box, options={**loop, "flip-x": flip}) for flip in (False, True)]
    for job, what in zip(jobs, ("cancel", "hold")):  # each while it runs
        wait_for_loop(shop, job)
        act(shop, what, job)
    assert shop.wait_for(jobs[0], "cancelled", seconds=60) and shop.wait_for(jobs[1], "held", seconds=60)
    assert one_node_slurm.queue() == []
    time.sleep(12)  # one that puts itself back is there again a second after cred_expire
    assert one_node_slurm.queue() == []
    act(shop, "retry", jobs[0])
    act(shop, "release", jobs[1])
    for job in jobs:
        shop.wait_for(job, "done", seconds=240)
        assert "--resume" in "".join(log.read_text() for log in (shop.folder / "jobs" / job / "cluster/batch/slurm/out").glob("*.log"))
    # Taken out by somebody else it is told as failed, and is handed over again only by a person.
    third = hand_in(shop, box, options={**loop, "size": "5.5mm"})
    wait_for_loop(shop, third)
    number = next(line.split()[0] for line in one_node_slurm.queue() if " R " in line)
    ask("scancel", number)
    told = shop.wait_for(third, "failed", seconds=120)
    assert "its tasks ended before it was done" in told["message"]
    act(shop, "retry", third)
    shop.wait_for(third, "done", seconds=240)
