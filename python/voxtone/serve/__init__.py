# SPDX-License-Identifier: GPL-3.0-or-later
"""`voxtone serve`: a page to work at and a service. It starts the program, it is not the program: each job is a process
in a folder of its own, and what happens to one of them, or to the service, leaves the others alone (docs/serve.md).

    files     upload.py     what is handed in, under limits
    jobs      store.py      one folder a job; states by rename
              runner.py     which runs now; process.py, walls.py: how it runs
              events.py     what browsers are told
    program   form.py       the form, the words of a command and the OpenAPI, all from the one table of options
              asking.py     what was read, estimates
    door      door.py       who gets in; routes.py: what there is; pages.py: without script
"""
