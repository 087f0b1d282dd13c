# SPDX-License-Identifier: GPL-3.0-or-later
"""Requests that nobody of good will sends: a list of our own, some 500, each with the bytes that are sent. What is expected
of each is a 4xx, or that the connection is closed."""
from __future__ import annotations

import itertools
import json
from typing import Iterator, List, NamedTuple, Tuple


class Hostile(NamedTuple):
    name: str
    data: bytes


def request(method: str, path: str, heads: List[Tuple[str, str]], body: bytes = b"", length: bool = True) -> bytes:
    lines = [f"{method} {path} HTTP/1.1", *(f"{name}: {value}" for name, value in heads)]
    if length and (body or method in ("POST", "PUT", "PATCH")):
        lines.append(f"Content-Length: {len(body)}")
    return "\r\n".join(lines).encode("utf-8", "surrogateescape") + b"\r\nConnection: close\r\n\r\n" + body


def requests(port: int, token: str, cookie: str, job: str, upload: str) -> Iterator[Hostile]:
    host, own = ("Host", f"127.0.0.1:{port}"), ("Origin", f"http://127.0.0.1:{port}")
    bearer, biscuit = ("Authorization", f"Bearer {token}"), ("Cookie", f"voxtone-{port}={cookie}")
    json_type, raw_type = ("Content-Type", "application/json"), ("Content-Type", "application/octet-stream")
    good = json.dumps({"upload": upload, "options": {"quality": "draft"}}).encode()
    reads = ["/", "/plain", "/jobs", f"/jobs/{job}", f"/jobs/{job}/report", f"/jobs/{job}/printer.zip", f"/jobs/{job}/log", "/events",
             f"/uploads/{upload}/read?name=box.glb", f"/uploads/{upload}/look?name=box.glb", f"/jobs/{job}/look?name=box.glb", "/options", "/openapi.json", "/printers", f"/uploads/{upload}", "/page/page.js", "/shop"]
    writes = [("POST", "/jobs"), ("POST", "/estimate"), ("POST", "/uploads?name=a.obj"), ("POST", f"/jobs/{job}/cancel"), ("DELETE", f"/jobs/{job}"),
              ("POST", "/plain")]

    # Nobody said who he is.
    wrong = ["", "x", token[:-1], token + "0", token.upper() if token.upper() != token else "f" * 32, "0" * 32, "é" * 16]
    for path in reads:
        yield Hostile(f"no token {path}", request("GET", path, [host]))
        for at, said in enumerate(wrong):
            yield Hostile(f"wrong token {at} {path}", request("GET", path, [host, ("Authorization", f"Bearer {said}")]))
    for said in wrong[1:]:
        yield Hostile(f"wrong address {said[:4]}", request("GET", f"/?token={said.encode().hex() if not said.isascii() else said}", [host]))
        yield Hostile(f"wrong cookie {said[:4]}", request("GET", "/jobs", [host, ("Cookie", f"voxtone-{port}={said}")]))
    yield Hostile("cookie of another port", request("GET", "/jobs", [host, ("Cookie", f"voxtone-{port + 1}={cookie}")]))
    yield Hostile("token as cookie", request("GET", "/jobs", [host, ("Cookie", f"voxtone-{port}={token}")]))
    yield Hostile("token not in the address of the page", request("GET", f"/jobs?token={token}", [host]))
    yield Hostile("basic", request("GET", "/jobs", [host, ("Authorization", f"Basic {token}")]))
    for method, path in writes:
        yield Hostile(f"no token {method} {path}", request(method, path, [host, own, json_type], good if method == "POST" else b""))

    # Another name for this machine; another page that asks.
    for name in ("evil.example", f"evil.example:{port}", "127.0.0.1", "127.0.0.1:1", f"127.0.0.1.evil.example:{port}", f"localhost.evil:{port}",
                 f"[::2]:{port}", "", " ", f"127.0.0.1:{port}@evil", f"0.0.0.0:{port}", f"127.1:{port}", f"LOCALHOST:{port + 1}"):
        yield Hostile(f"Host {name!r}", request("GET", "/jobs", [("Host", name), bearer]))
        yield Hostile(f"Host {name!r} post", request("POST", "/jobs", [("Host", name), bearer, json_type], good))
    yield Hostile("two hosts", request("GET", "/jobs", [host, ("Host", "evil.example"), bearer]))
    yield Hostile("no host", request("GET", "/jobs", [bearer]))
    yield Hostile("address with a host", request("GET", f"http://evil.example:{port}/jobs", [host, bearer]))
    for origin in ("http://evil.example", "null", "", f"http://127.0.0.1:{port + 1}", f"http://localhost:{port}", f"http://127.0.0.1:{port}.evil",
                   f"file://127.0.0.1:{port}", f"http://127.0.0.1:{port}/x", f"http://evil@127.0.0.1:{port}"):
        for method, path in writes:
            yield Hostile(f"Origin {origin!r} {method} {path}",
                          request(method, path, [host, biscuit, ("Origin", origin), json_type], good if method == "POST" else b""))
    for method, path in writes:
        body = good if method == "POST" else b""
        yield Hostile(f"cookie without origin {method} {path}", request(method, path, [host, biscuit, json_type], body))
        yield Hostile(f"cross site {method} {path}", request(method, path, [host, biscuit, own, ("Sec-Fetch-Site", "cross-site"), json_type], body))
        yield Hostile(f"same site {method} {path}", request(method, path, [host, biscuit, own, ("Sec-Fetch-Site", "same-site"), json_type], body))

    # Bodies that other pages can send without being asked.
    for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x", "", "application/jsonx", "text/json"):
        yield Hostile(f"body {kind}", request("POST", "/jobs", [host, bearer, ("Content-Type", kind)], good))
    for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x"):
        yield Hostile(f"upload as {kind}", request("POST", "/uploads?name=a.obj", [host, bearer, ("Content-Type", kind)], b"v 0 0 0\n"))
    for body in (b"--x--", b"", b"--x\r\n\r\nv\r\n--x--\r\n", b"--x\r\nContent-Disposition: form-data; name=\"file\"; filename=\"a.obj\"\r\n\r\nv\r\n--x--\r\n",
                 b"--x\r\nContent-Disposition: form-data; name=\"form\"\r\n\r\nwrong\r\n--x--\r\n", b"--x\r\nContent-Disposition: form-data; name=\"form\"\r\n\r\n",
                 b"--x\r\n" + b"a" * 9000):
        yield Hostile(f"form {body[:20]!r}", request("POST", "/plain", [host, bearer, ("Content-Type", "multipart/form-data; boundary=x")], body))

    # Methods and first lines.
    for method in ("PUT", "PATCH", "OPTIONS", "TRACE", "CONNECT", "PROPFIND", "get", "GETT", "", "G\tET", "POST\0"):
        yield Hostile(f"method {method!r}", request(method, "/jobs", [host, bearer], b"{}" if method in ("PUT", "PATCH") else b""))
    for line in (b"GET /jobs\r\n\r\n", b"GET\r\n\r\n", b"\r\n\r\n\r\n\r\n", b"GET /jobs HTTP/9.9\r\n\r\n", b"GET /jobs HTTP/2.0\r\n\r\n", b"GET /jobs HTTP/1.1 x\r\n\r\n",
                 b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(40), b"GET  /jobs HTTP/1.1\r\n\r\n", b"GET /jobs http/1.1\r\n\r\n", bytes(range(256)) + b"\r\n\r\n",
                 b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", b"GET /" + b"a" * 70000 + b" HTTP/1.1\r\n\r\n", b"A" * 70000 + b"\r\n\r\n"):
        yield Hostile(f"line {line[:20]!r}", line)
    plain = f"GET /jobs HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAuthorization: Bearer {token}\r\n".encode()
    for head in (b"X: " + b"a" * 70000 + b"\r\n\r\n", b"".join(b"X%d: a\r\n" % at for at in range(150)) + b"\r\n", b"Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello",
                 b"Content-Length: -1\r\n\r\n", b"Content-Length: 0x10\r\n\r\n", b"Content-Length: 1e3\r\n\r\n", b"Content-Length: 99999999999999999999\r\n\r\n",
                 b"Content-Length: 5\r\n\r\nhello", b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n", b"Transfer-Encoding: identity\r\n\r\n", b"Content-Encoding: gzip\r\n\r\n",
                 b"Content-Length: +5\r\n\r\n", b"Content-Length: 5, 5\r\n\r\nhello", b"Transfer-Encoding: chunked\r\nContent-Length: 3\r\n\r\n0\r\n\r\n",
                 b"Authorization: Bearer x\r\n\r\n", b"Origin: a\r\nOrigin: b\r\n\r\n", b" folded: x\r\n\r\n", b"no colon here\r\n\r\n", b"Bad Name: x\r\n\r\n"):
        yield Hostile(f"head {head[:30]!r}", plain + b"Connection: close\r\n" + head)

    # Ids and paths.
    ids = ["0" * 32, "f" * 32, job[:-1], job + "0", job.upper() if job.upper() != job else "F" * 32, job.translate({ord("0") + i: ord("0") + (i + 1) % 10 for i in range(10)}),
           "..", ".", "%2e%2e", "1", "-1", "*", "jobs", "null", "constructor", job + "%00", job + "/", job + ".json", "%" + job, f"{job};{job}"]
    for wrong_id in ids:
        for below in ("", "/report", "/printer.zip", "/log"):
            yield Hostile(f"id {wrong_id[:12]} {below}", request("GET", f"/jobs/{wrong_id}{below}", [host, bearer]))
        yield Hostile(f"id {wrong_id[:12]} cancel", request("POST", f"/jobs/{wrong_id}/cancel", [host, bearer, json_type], b"{}"))
        yield Hostile(f"upload id {wrong_id[:12]}", request("POST", f"/uploads?name=a.obj&into={wrong_id if '%' not in wrong_id and ';' not in wrong_id else 'x'}",
                                                             [host, bearer, raw_type], b"v"))
    climbs = ["..", "%2e%2e", "..%2f..", "%2e%2e%2f", "..\\", "..%5c", "%252e%252e", "..%c0%af", "%c0%ae%c0%ae", "..;", "....//", ".%00.", "%uff0e%uff0e"]
    for climb in climbs:
        for base in ("/page/", f"/jobs/{job}/", f"/jobs/{job}/layers/", "/", f"/uploads/{upload}/"):
            yield Hostile(f"climb {base[:8]}{climb}", request("GET", f"{base}{climb}/{climb}/etc/passwd", [host, bearer]))
    for path in ("//etc/passwd", "/page/../../store.py", "/page/index.html/..", "/page/", "/page/__init__.py", "/token", "/shop.json", "/jobs/", f"/jobs/{job}/state.json",
                 f"/jobs/{job}/job.json", f"/jobs/{job}/input/box.glb", f"/jobs/{job}/layers/99999.png", f"/jobs/{job}/layers/-1.png", f"/jobs/{job}/layers/1.png.png",
                 f"/jobs/{job}/layers/0000000001.png", f"/jobs/{job}/report/x", f"/jobs/{job}/out.zip/..", "*", "/\u00e4", "/jobs?x", "/jobs?x=%ff", "/jobs?a=1&a=2",
                 "/jobs?" + "&".join(f"a{at}=1" for at in range(50)), "/server-status", "/.git/config", "/jobs#x\\"):
        yield Hostile(f"path {path[:30]}", request("GET", path, [host, bearer]))
    for name in ("", "..", "../a.obj", "../../token", "/etc/passwd", "a/../../b", ".hidden", "a/.b", "a\\b", "%00", "a%00.obj", "a%0d%0ab", "a" * 300, "/".join("a" * 30),
                 "a/", "/", "..%2fa.obj", "%2e%2e%2fa.obj", "%ff.obj", "./a.obj", "a//b"):
        said = name if name.startswith("%") or "%" in name else name.replace("/", "%2F").replace("\\", "%5C")
        yield Hostile(f"upload name {name[:20]!r}", request("POST", f"/uploads?name={said}", [host, bearer, raw_type], b"v 0 0 0\n"))
        if "%" not in name and name:
            yield Hostile(f"picture name {name[:20]!r}", request("GET", f"/uploads/{upload}/picture?name={said}", [host, bearer]))

    for what, at in itertools.product(("read", "look"), (f"/uploads/{upload}", f"/jobs/{job}")):
        for said in ("", "?name=", "?name=..%2Ftoken", "?name=%2Fetc%2Fpasswd", "?name=box.glb&options=%5B%5D", "?name=box.glb&options=%7B", "?name=box.glb&options=1", "?name=no.obj",
                     "?name=box.glb&options=" + "%5B" * 1000, "?name=box.glb&name=a", "?name=box.glb&options=%7B%22picture%22%3A%22%2Ftmp%2Fevil.png%22%7D",
                     "?name=box.glb&options=%7B%22overwrite%22%3Atrue%7D", "?name=box.glb&options=%7B%22texture%22%3A%22..%2Fx.png%22%7D",
                     "?name=box.glb&options=%7B%22size%22%3A%22banana%22%7D"):
            yield Hostile(f"{what} {at[:4]} {said[:30]}", request("GET", f"{at}/{what}{said}", [host, bearer]))

    # What a job is asked to be.
    bad: List[object] = [[], 1, "x", None, {"upload": upload, "options": []}, {"upload": upload, "options": {"size": {"a": 1}}}, {"upload": [], "options": {}},
                         {"job": "..", "options": {}}, {"upload": upload, "model": "../../token"}, {"upload": upload, "model": "/etc/passwd"}, {"upload": upload, "model": 5},
                         {"upload": upload, "model": "no.obj"}, {"upload": upload, "copies": 10 ** 9}, {"upload": upload, "copies": -1}, {"upload": upload, "copies": "2"},
                         {"upload": upload, "copies": 1.5}, {"upload": upload, "name": ["x"]}, {"upload": upload, "name": "x" * 10000}, {"upload": upload, "parts": []},
                         {"upload": upload, "parts": [1]}, {"upload": upload, "parts": [{"model": "../x.obj"}]}, {"upload": upload, "parts": [{"model": "box.glb"}] * 501},
                         {"upload": upload, "parts": [{"stack": "/etc"}]}, {"upload": upload, "parts": [{"model": "box.glb", "out": "/tmp/x"}]},
                         {"upload": upload, "copies": True}]
    deep: object = 1
    for _ in range(100):
        deep = [deep]
    for value in (float("nan"), float("inf"), deep):  # what no browser reads, and what a store cannot read again
        bad.append({"upload": upload, "parts": [{"model": "box.glb", "at": [value, 0]}]})
    for name, value in (("out", "/tmp/evil"), ("for-printer", "/tmp/evil"), ("for_printer", "x"), ("overwrite", True), ("job", "/etc/passwd"), ("threads", 4096), ("dump-default", True),
                        ("json", False), ("mixtures", "/etc/passwd"), ("shard", "1/2"), ("until", "loop"), ("resume", True), ("mesh", "/etc/passwd"), ("no-such", 1), ("", 1), ("-o", "x"),
                        ("--out", "/tmp/evil"), ("printer", "/etc/passwd"), ("printer", "../../x.json"), ("resins", "~/x"), ("texture", "/etc/passwd"), ("texture", "a/../../b"),
                        ("decal", "/etc/passwd; place=top"), ("decal", ["a.png", "../b.png"]), ("label", "x; font=/usr/share/fonts/x.ttf"), ("laminate-materials", "W=/etc/passwd"),
                        ("profiles", "../../map.json"), ("size", "a" * 5000), ("size", "1\n2"), ("label", ["x"] * 300), ("size", True), ("flip-x", "yes"), ("size", [1, 2]),
                        ("size", "\u0000"), ("quality", "fine"), ("size", "banana"), ("iterations", "-5"), ("printer", "no-such-printer")):
        bad.append({"upload": upload, "options": {name: value}})
    for value, path in itertools.product(bad, ("/jobs", "/estimate")):
        skip = path == "/estimate" and isinstance(value, dict) and ("copies" in value or "name" in value)
        # What the program judges when it opens a job is a failed job, with its sentence.
        skip = skip or path == "/jobs" and isinstance(value, dict) and not {"iterations", "printer"}.isdisjoint(value.get("options") or []) and "/" not in str(value)
        if not skip:
            yield Hostile(f"{path} {json.dumps(value)[:60]}", request("POST", path, [host, bearer, json_type], json.dumps(value).encode()))
    for body in (b"{", b"", b"\xff\xfe", b"[" * 100000, b'{"upload": "' + b"a" * 2000000 + b'"}', b"null", b'{"a": 1e999, "upload": NaN}', b"{} {}", b"\x00" * 100,
                 b'{"upload": "%s", "parts": [{"model": "box.glb", "at": [1e999, 0]}]}' % upload.encode()):
        yield Hostile(f"json {body[:12]!r}", request("POST", "/jobs", [host, bearer, json_type], body))
    for key in ("x", "a b c d e f g", "../../../etc", "é" * 10, "k" * 200):
        yield Hostile(f"key {key[:8]}", request("POST", "/jobs", [host, bearer, json_type, ("Idempotency-Key", key)], good))

    # Half, slow, too much.
    yield Hostile("half a head", b"GET /jobs HTTP/1.1\r\nHost: x\r\n")
    yield Hostile("half a body", request("POST", "/jobs", [host, bearer, json_type, ("Content-Length", "100")], b"{", length=False))
    yield Hostile("half an upload", request("POST", "/uploads?name=half.obj", [host, bearer, raw_type, ("Content-Length", "100000")], b"v 0 0 0\n", length=False))
    yield Hostile("more than said", request("POST", "/jobs", [host, bearer, json_type, ("Content-Length", "2")], b"{}GET /jobs HTTP/1.1\r\n\r\n", length=False))
    yield Hostile("a file too large", request("POST", "/uploads?name=a.obj", [host, bearer, raw_type, ("Content-Length", str(10 ** 12))], b"v", length=False))
    yield Hostile("no length", request("POST", "/jobs", [host, bearer, json_type], good, length=False))
