# SPDX-License-Identifier: GPL-3.0-or-later
"""voxtone from Python: start its verbs, follow and cancel them, read what they made as arrays.

    import voxtone
    job = voxtone.slice("cow.glb", size="60mm", out="out/cow")
    for event in job: ...            # or progress=callback
    stack = job.result()             # a Print; raises voxtone.Error with the program's own sentence
    stack.layer(100)                 # resin of every voxel of a layer, 0 is nothing

A verb takes the options of its command line as keywords (`help(voxtone.slice)`), and returns a Job. docs/python.md
"""
from .bssrdf import write_bssrdf
from .errors import (Bug, CheckFailed, Cancelled, Error, FileError, InputError, Killed, ProgramMissing, Stopped,
                     TryAgain, Unfinished, UsageError, Warned)
from .job import Job
from .mesh import Mesh, read_mesh
from .options import Command, Option, option_table
from .prints import Print, open_print as open
from .program import program, version
from .remote import connect
from .verbs import (batch, calibrate, compare, estimate, laminate, list, merge, predict, printers, proof, read,
                    resin_sets, slice, status, target, tray, verify)

__all__ = ["Bug", "Cancelled", "CheckFailed", "Command", "Error", "FileError", "InputError", "Job", "Killed", "Mesh",
           "Option", "Print", "ProgramMissing", "Stopped", "TryAgain", "Unfinished", "UsageError", "Warned", "batch",
           "calibrate", "compare", "connect", "estimate", "laminate", "list", "merge", "open", "option_table", "predict",
           "printers", "program", "proof", "read", "read_mesh", "resin_sets", "slice", "status", "target", "tray",
           "verify", "version", "write_bssrdf"]
