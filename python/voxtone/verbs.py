# SPDX-License-Identifier: GPL-3.0-or-later
"""The verbs of the program as functions; what they take comes from its table of options."""
from __future__ import annotations

import hashlib
import inspect
import tempfile
from pathlib import Path
from typing import Any, Callable, Dict, List as ListOf, Optional, Sequence, Tuple

from .job import Job, Progress
from .mesh import Mesh
from .options import Command, option_table, run_by_package
from .prints import Print

_several = (list, tuple)  # before `list` is a verb
#: Verbs whose result is a stack in the folder `out`.
_makes_a_print = {("slice",), ("tray",), ("merge",)}


class Verb:
    """Called, it starts the verb and returns its Job. Steps of a family are attributes: voxtone.calibrate.fit(...)."""

    def __init__(self, *path: str) -> None:
        self._path = path

    def _command(self) -> Command:
        command = option_table()[self._path[0]]
        for name in self._path[1:]:
            found = command.step(name)
            if not found:
                raise AttributeError(f"voxtone {' '.join(command.path)} has no step {name!r}; there are "
                                     + ", ".join(step.path[-1].replace("-", "_") for step in command.steps))
            command = found
        return command

    def __getattr__(self, name: str) -> "Verb":
        if name.startswith("_"):
            raise AttributeError(name)
        step = Verb(*self._path, name)
        step._command()
        return step

    def __dir__(self) -> ListOf[str]:
        return [step.path[-1].replace("-", "_") for step in self._command().steps]

    @property
    def __name__(self) -> str:
        return self._path[-1]

    @property
    def __signature__(self) -> inspect.Signature:
        return self._command().signature()

    @property
    def __doc__(self) -> str:  # type: ignore[override]
        return self._command().documentation()

    def __repr__(self) -> str:
        return f"<voxtone {' '.join(self._path)}>"

    def __call__(self, *arguments: Any, progress: Optional[Progress] = None, **options: Any) -> Job:
        command = self._command()
        if command.steps:
            raise TypeError(f"voxtone {' '.join(self._path)} wants a step: " + ", ".join(self.__dir__()))
        for name in run_by_package:
            if name in options:
                raise TypeError(f"{name} is decided by this package; progress=callback, or iterate over the job")
        files = _Meshes(options.get("out") if self._path in _makes_a_print else None)
        places, options = files.named(arguments, options)
        words = command.words(places, options)
        if any(option.name == "json" for option in command.options):
            words.insert(len(command.path), "--json")
        return Job(words, self._finish(options), progress, files.cleanup)

    def _finish(self, options: Dict[str, Any]) -> Callable[[Any], Any]:
        if self._path in _makes_a_print and options.get("out") and not options.get("shard"):
            return lambda result: Print(options["out"], result)
        return lambda result: result


class _Meshes:
    """Arrays among the arguments go to the program as files. Where the verb has a folder OUT they lie in OUT/models before it
    begins and stay there, so that its job file and its plan lead to them; without one they are gone with the job."""

    def __init__(self, out: Optional[Any]) -> None:
        self._folder = Path(out) / "models" if out else None
        self._made: ListOf[Path] = []
        self._count = 0

    def named(self, arguments: Sequence[Any], options: Dict[str, Any]) -> Tuple[ListOf[Any], Dict[str, Any]]:
        return [self._name(a) for a in arguments], {key: self._name(value) for key, value in options.items()}

    def _name(self, value: Any) -> Any:
        if isinstance(value, _several):
            return [self._name(v) for v in value]
        if isinstance(value, Print):
            return value.path
        if not isinstance(value, Mesh):
            return value
        self._count += 1
        with tempfile.TemporaryDirectory(prefix="voxtone-") as folder:
            file = Path(folder) / f"model{self._count if self._count > 1 else ''}.glb"
            value.write(file)
            return self._kept(file)

    def _kept(self, file: Path) -> Path:
        """The same mesh has the same name again, what somebody else keeps by that name stays."""
        content = file.read_bytes()
        folder = self._folder or Path(tempfile.mkdtemp(prefix="voxtone-"))
        folder.mkdir(parents=True, exist_ok=True)
        kept = folder / file.name
        if kept.exists() and kept.read_bytes() != content:
            kept = folder / f"{file.stem}-{hashlib.sha256(content).hexdigest()[:12]}.glb"
        if not kept.exists():
            kept.write_bytes(content)
            self._made.append(kept)
        return kept

    def cleanup(self, succeeded: bool) -> None:
        out = self._folder.parent if self._folder else None
        if out and out.is_dir() and (succeeded or any(one != self._folder for one in out.iterdir())):
            return  # also of a job that was stopped, and can go on
        for file in self._made:
            file.unlink(missing_ok=True)
            for folder in (file.parent, file.parent.parent) if self._folder else (file.parent,):
                try:
                    folder.rmdir()
                except OSError:  # others have something there
                    break


slice = Verb("slice")  # pylint: disable=redefined-builtin
tray = Verb("tray")
read = Verb("read")
estimate = Verb("estimate")
merge = Verb("merge")
predict = Verb("predict")
proof = Verb("proof")
compare = Verb("compare")
verify = Verb("verify")
batch = Verb("batch")
status = Verb("status")
target = Verb("target")
laminate = Verb("laminate")
calibrate = Verb("calibrate")
list = Verb("list")  # pylint: disable=redefined-builtin


def printers() -> ListOf[Dict[str, Any]]:
    """That the program knows, as `voxtone list printers --json` tells of them."""
    return list("printers").result()


def resin_sets() -> ListOf[Dict[str, Any]]:
    return list("resins").result()
