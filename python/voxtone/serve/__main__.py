# SPDX-License-Identifier: GPL-3.0-or-later
"""`voxtone serve` runs this with its options, which it has read already."""
from __future__ import annotations

import argparse
import os
import signal
import sys
import threading
import webbrowser
from pathlib import Path

from ..errors import Error
from ..options import option_table
from . import walls
from .cluster import Cluster
from .door import Service
from .limits import GB, Limits
from .routes import Routes
from .shop import Shop, ShopIsTaken
from .watch import NoQueue


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="voxtone serve", description="A page to work at, and a service")
    parser.add_argument("--folder", type=Path, default=Path("shop"))
    parser.add_argument("--port", type=int, default=8750)
    parser.add_argument("--listen", default="127.0.0.1")
    parser.add_argument("--host", action="append", default=[])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--memory", type=float, default=0)
    parser.add_argument("--keep-days", type=float, default=0)
    parser.add_argument("--keep-size", type=float, default=0)
    parser.add_argument("--watch", action="append", default=[])
    parser.add_argument("--slurm", action="store_true")
    parser.add_argument("--sbatch-option", action="append", default=[])
    parser.add_argument("--no-browser", action="store_true")
    return parser.parse_args()


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _open_browser(address: str) -> None:
    if os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()


def _wait_for_signal() -> None:
    asked = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: os._exit(85) if asked.is_set() else asked.set())  # the second time at once
    while not asked.wait(3600):
        pass


def serve(options: argparse.Namespace) -> int:
    limits = Limits()
    cluster = Cluster(tuple(options.sbatch_option)) if options.slurm else None
    if cluster and cluster.why_not():
        raise NoQueue(cluster.why_not())
    shop = Shop(options.folder, limits, options.jobs, int(options.memory * GB), options.keep_days, int(options.keep_size * GB), cluster)
    shop.watch(options.watch)
    option_table()
    service = Service((options.listen, options.port), shop.token, limits, options.host, Routes(shop))
    name = "127.0.0.1" if options.listen in ("127.0.0.1", "localhost", "0.0.0.0", "::", "::1") else options.listen
    if options.listen not in ("127.0.0.1", "localhost", "::1"):
        service.hosts.add(f"{options.listen}:{service.port}")
        _say("Others on the network can reach this: put a proxy with TLS before it, name it with --host, and give the token only to "
             "who may print.")
    if walls.landlock_version() < 2:
        _say("This kernel cannot wall jobs in their folders (Landlock, Linux 5.19): serve only people whom you trust with your files.")
    address = f"http://{name}:{service.port}/?token={shop.token.text}"
    shop.begin()
    print(address, flush=True)
    _say(f"The shop is {shop.folder}. Ctrl-C ends; jobs go on when it is started again.")
    if not options.no_browser:
        _open_browser(address)
    threading.Thread(target=service.serve_forever, kwargs={"poll_interval": 3600}, daemon=True).start()
    _wait_for_signal()
    _say("Jobs save themselves; once more Ctrl-C ends at once, and they work on.")
    shop.stop()
    return 0


def main() -> int:
    options = _options()
    try:
        return serve(options)
    except (ShopIsTaken, NoQueue) as refusal:
        _say(f"voxtone: {refusal} [invalid-input]")
        return 3
    except Error as error:
        _say(f"voxtone: {error}")
        return error.exit_code
    except OSError as error:
        _say(f"voxtone: the service cannot begin: {error}; is another program at --port {options.port}, may you write to "
             f"{options.folder}? [file]")
        return 4


if __name__ == "__main__":
    sys.exit(main())
