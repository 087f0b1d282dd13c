# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs test programs of the copy: with no mutant awake, with one, and to learn which cases come by which mutants."""
import glob
import os
import re
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass, field

from weave import REACHED, VARIABLE

LEAST_S, TIMES = 10, 10  # a test with a mutant may take 10 s and 10 times as long as without


@dataclass
class Case:
    program: str
    name: str
    seconds: float = 0
    reaches: set = field(default_factory=set)


class Runner:
    def __init__(self, copy):
        self.copy = copy
        self.limits = {}

    def start(self, program, words, number, limit, reached=None):
        """Exit code (None where it took longer than `limit` seconds) and output."""
        found = glob.glob(f"{self.copy}/build/release/tests/**/{program}", recursive=True)
        path = next(p for p in found if os.path.isfile(p))
        with tempfile.TemporaryDirectory(prefix="voxtone-mutant-", ignore_cleanup_errors=True) as folder:
            environment = dict(os.environ, TMPDIR=folder, **{VARIABLE: str(number)}, **({REACHED: reached} if reached else {}))
            child = subprocess.Popen([path, *words], env=environment, start_new_session=True, text=True, errors="replace", cwd=folder,
                                     stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            try:
                output, _ = child.communicate(timeout=limit)
            except subprocess.TimeoutExpired:
                os.killpg(child.pid, signal.SIGKILL)
                child.communicate()
                return None, ""
        return child.returncode, output

    def run(self, test, number, limit):
        """What the test, "program" or "program: case", said of mutant `number`, 0 for none: None where it passed."""
        program, _, case = test.partition(":")
        return self.said(program, ["-a"] + ([case.strip()] if case else []), number, limit)

    def said(self, program, words, number, limit):
        code, output = self.start(program, words, number, limit)
        if code is None:
            return f"{program}: not done in {limit:.0f} s"
        if code in (0, 77):
            return None
        failed = re.search(r"(\S+?):(\d+): FAILED", output)
        where = f"{failed[1]}:{failed[2]}" if failed else f"ended with {code}"
        return f"{program}: {where}"

    def measure(self, test):
        """Passes the test without a mutant? Its time with one may be ten times as long. A test that fails kills nothing."""
        begin = time.monotonic()
        said = self.run(test, 0, 3600)
        if said:
            print(f"left out, it fails without a mutant: {test} - {said}", flush=True)
            return
        self.limits[test] = LEAST_S + TIMES * (time.monotonic() - begin)

    def cases(self, program):
        """The cases of a program that are labelled as it is: not [slow]."""
        _, output = self.start(program, ["--list-test-names-only", "~[slow]"], 0, 60)
        return [Case(program, name.strip()) for name in output.splitlines() if name.strip()]

    def learn(self, case):
        """Runs a case that passes without a mutant, and writes down what it comes by. Does it pass?"""
        with tempfile.NamedTemporaryFile("r", prefix="voxtone-reached-") as told:
            begin = time.monotonic()
            code, output = self.start(case.program, ["-a", escaped(case.name)], -1, 600, told.name)
            case.seconds = time.monotonic() - begin
            case.reaches = {int(line) for line in told.read().split()}
        if code not in (0, 77):
            print(f"left out, it fails without a mutant: {case.program}: {case.name}\n{output[-500:]}", flush=True)
        return code in (0, 77)

    def verdict(self, number, cases):
        """What kills a mutant, of cases that come by it, the quick ones first; None where nothing does."""
        for case in sorted((case for case in cases if number in case.reaches), key=lambda case: case.seconds):
            said = self.said(case.program, ["-a", escaped(case.name)], number, LEAST_S + TIMES * case.seconds)
            if said:
                return said
        return None


def escaped(name):
    """A name as Catch2 takes it on a command line."""
    return re.sub(r"([\\,\[\]\"])", r"\\\1", name).replace("*", "\\*") if name[:1] not in "~" else "\\" + name
