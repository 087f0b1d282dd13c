# SPDX-License-Identifier: GPL-3.0-or-later
"""What a type checker says of the package, and of scripts that use it with the types made for editors."""
import shutil
import subprocess
from pathlib import Path

import pytest

from voxtone.stubs import stub

package = Path(__file__).resolve().parents[1]
script = """
import voxtone
from pathlib import Path
job = voxtone.slice("cow.glb", size="60mm", quality="draft", report=False, out=Path("out"), load=["C", "M"], formats=["png", "gcvf"],
                    progress=lambda event: print(event["event"]))
for event in job:
    print(event)
stack = voxtone.open("out")
stack.proof("seen.png", camera=(0, -200, 80)).result()
stack.predict("seen.ply", predict="monte-carlo").result()
voxtone.calibrate.edge.fit("plan.json", out="resins.json")
voxtone.verify(stack).warnings[0].upper()
"""


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """What the checker found of Python and numpy, by far the most, is found once for all tests."""
    return tmp_path_factory.mktemp("cache")


def checked(folder, cache, *names):
    checker = shutil.which("mypy") or pytest.skip("mypy is not installed (tools/install-packages tests)")
    return subprocess.run([checker, "--config-file", str(package / "pyproject.toml"), "--cache-dir", str(cache),
                           *names], cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("installed")
    shutil.copytree(package / "voxtone", folder / "voxtone", ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "voxtone/verbs.pyi").write_text(stub())
    return folder


def test_the_package(cache):
    done = checked(package, cache, "voxtone")
    assert done.returncode == 0, done.stdout


def test_a_script_with_the_types_of_verbs(installed, cache):
    (installed / "good.py").write_text(script)
    done = checked(installed, cache, "good.py")
    assert done.returncode == 0, done.stdout


def test_mistakes_are_seen_before_they_run(installed, cache):
    changes = {'size="60mm"': "sise=[1]", "report=False": 'report="no"', "quality=": "thickness=[1], quality=",
               "event[": "event.stage["}
    for at, (right, wrong) in enumerate(changes.items()):
        assert right in script
        (installed / f"bad{at}.py").write_text(script.replace(right, wrong))
    done = checked(installed, cache, *(f"bad{at}.py" for at in range(len(changes))))
    for at in range(len(changes)):
        assert f"bad{at}.py:" in done.stdout, (at, done.stdout)
