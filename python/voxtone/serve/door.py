# SPDX-License-Identifier: GPL-3.0-or-later
"""Who gets in. Every request passes here before anything looks at what it asks for: its form (one Host, one length, no
encodings of bodies), its Host (names rebound to this machine), its token or cookie, its Origin where it changes anything.
Whatever is refused is a 4xx with one sentence, after which the connection is closed."""
from __future__ import annotations

import json
import re
import socket
import sys
import threading
import time
import traceback
import urllib.parse
from email.errors import FirstHeaderLineIsContinuationDefect, MalformedHeaderDefect, MissingHeaderBodySeparatorDefect
from http.cookies import CookieError, SimpleCookie
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Dict, Iterable, Optional, Tuple

from .limits import Limits, bytes_text
from .refusal import Refusal, json_of
from .tokens import Token

_page_policy = ("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; frame-src 'self'; "
                "form-action 'self'; base-uri 'none'; frame-ancestors 'none'")
#: What a job made is looked at from outside of everything else: it has an origin of its own, and no network.
sandbox_policy = ("sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                  "img-src data: blob:; font-src data:; connect-src data: blob:; worker-src blob:; base-uri 'none'; form-action 'none'; "
                  "frame-ancestors 'self'")
_changes = ("POST", "DELETE")
_methods = ("GET", "HEAD", *_changes)
_is_name = re.compile(r"[!-~]+\Z").match
#: What of a head's faults is of the head itself: of multipart bodies it says some that lie in wait of the body.
_unreadable = (MissingHeaderBodySeparatorDefect, FirstHeaderLineIsContinuationDefect, MalformedHeaderDefect)
_once = ("host", "content-length", "content-type", "origin", "authorization", "transfer-encoding", "idempotency-key", "sec-fetch-site")


class Connections:
    """How many there are, and until when each has to have said what it wants. One thread looks, while there are any."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._until: Dict[socket.socket, float] = {}
        self._open: Dict[socket.socket, float] = {}
        self._changed = threading.Condition()
        self.watchers = threading.BoundedSemaphore(limits.watchers)
        threading.Thread(target=self._look, name="connections", daemon=True).start()

    def has_room_for(self, connection: socket.socket) -> bool:
        """Where there is none, who has waited longest without a request goes first."""
        with self._changed:
            if len(self._open) >= self._limits.connections:
                silent = min(self._until, key=lambda one: self._until[one], default=None)
                if silent is None:
                    return False
                self._close(silent)
                self._open.pop(silent, None)
            self._open[connection] = time.monotonic()
            return True

    def forget(self, connection: socket.socket) -> None:
        with self._changed:
            self._open.pop(connection, None)
            self._until.pop(connection, None)

    def expect(self, connection: socket.socket, seconds: Optional[float]) -> None:
        """Nothing: it has said what it wants."""
        with self._changed:
            if seconds is None:
                self._until.pop(connection, None)
            else:
                self._until[connection] = time.monotonic() + seconds
                self._changed.notify()

    def _close(self, connection: socket.socket) -> None:
        self._until.pop(connection, None)
        try:
            connection.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass

    @staticmethod
    def _refuse(connection: socket.socket) -> None:
        try:
            connection.send(b"HTTP/1.1 408 Request Timeout\r\nConnection: close\r\nContent-Length: 0\r\n\r\n", socket.MSG_DONTWAIT)
        except OSError:
            pass

    def _look(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._until)
                for connection, until in list(self._until.items()):
                    if until < time.monotonic():
                        self._refuse(connection)
                        self._close(connection)
            time.sleep(0.5)


class Service(ThreadingHTTPServer):
    daemon_threads = True
    allow_reuse_address = True
    request_queue_size = 128

    def __init__(self, address: Tuple[str, int], token: Token, limits: Limits, hosts: Iterable[str], routes: Any) -> None:
        if ":" in address[0]:
            self.address_family = socket.AF_INET6
        super().__init__(address, Door)
        self.token, self.limits, self.routes = token, limits, routes
        self.port = self.server_address[1]
        self.connections = Connections(limits)
        own = [f"{name}:{self.port}" for name in ("127.0.0.1", "localhost", "[::1]")]
        self.hosts = {*own, *(host.lower() for host in hosts)}
        self.cookie_name = f"voxtone-{self.port}"  # cookies know no ports

    def process_request(self, request: Any, client_address: Any) -> None:
        if not self.connections.has_room_for(request):
            self.shutdown_request(request)
            return
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        self.connections.forget(request)
        super().shutdown_request(request)

    def server_bind(self) -> None:
        # Without a look-up of the machine's name, which may wait for a network.
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind(self.server_address)
        self.server_address = self.socket.getsockname()
        self.server_name, self.server_port = str(self.server_address[0]), self.server_address[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Who went away in the middle is nothing to tell of."""
        if not isinstance(sys.exc_info()[1], (ConnectionError, TimeoutError, socket.timeout)):
            traceback.print_exc()


class Door(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: Service
    error_content_type = "application/json"
    raw_requestline: bytes

    def setup(self) -> None:
        super().setup()
        self.connection.settimeout(self.server.limits.silence_s)
        self.body_left = 0
        self.by_token = False
        self._expect(self.server.limits.head_s)

    def _expect(self, seconds: Optional[float]) -> None:
        self.server.connections.expect(self.connection, seconds)

    def handle_one_request(self) -> None:
        self._expect(self.server.limits.head_s)
        super().handle_one_request()

    # Form.

    def parse_request(self) -> bool:
        self.command = ""
        self.close_connection = True
        self.requestline = line = str(self.raw_requestline, "iso-8859-1").rstrip("\r\n")
        words = line.split()
        if " ".join(words) != line or len(words) != 3 or words[2] not in ("HTTP/1.1", "HTTP/1.0"):
            self.send_error(400)
            return False
        if not super().parse_request():
            return False
        self._expect(None)
        if self.command not in _methods:
            self.send_error(405)
            return False
        return True

    def _answer(self) -> None:
        try:
            self._check_form()
            self._check_host()
            path, query = self._target()
            if self._takes_token(path, query):
                return
            self._check_who()
            if self.command in _changes:
                self._check_origin()
            self.server.routes.answer(self, "GET" if self.command == "HEAD" else self.command, path, query)
        except Refusal as refusal:
            self.refuse(refusal)
        except (ConnectionError, socket.timeout):
            self.close_connection = True
        except Exception:  # pylint: disable=broad-except
            traceback.print_exc()
            self.close_connection = True
            self.send_json({"error": "a bug of voxtone: please report what stands where the service was started"}, 500)
        if self.body_left:
            self.close_connection = True

    do_GET = do_HEAD = do_POST = do_DELETE = _answer

    def _check_form(self) -> None:
        for name in set(self.headers.keys()):
            if not _is_name(name) or (name.lower() in _once and len(self.headers.get_all(name) or []) != 1):
                raise Refusal(400, "a head of the request is said twice, or has no name")
        if any(isinstance(defect, _unreadable) for defect in self.headers.defects) or any(
                "\n" in value or "\r" in value for value in self.headers.values()):
            raise Refusal(400, "the head of the request cannot be understood")
        if self.headers.get("Transfer-Encoding") or self.headers.get("Content-Encoding"):
            raise Refusal(411, "bodies are sent as they are, with their length")
        length = self.headers.get("Content-Length", "0")
        if not re.fullmatch(r"[0-9]{1,15}", length):
            raise Refusal(400, "Content-Length is a number")
        self.body_left = int(length)
        if self.body_left and self.command not in ("POST",):
            raise Refusal(400, f"{self.command} takes no body")
        if self.command == "POST" and "Content-Length" not in self.headers:
            raise Refusal(411, "say how long the body is: Content-Length")

    def _check_host(self) -> None:
        if self.headers.get("Host", "").lower() not in self.server.hosts:
            raise Refusal(421, "this service is not known by that name; use the address that it printed, or start it with --host NAME")

    def _target(self) -> Tuple[str, Dict[str, str]]:
        if not self.path.startswith("/") or self.path.startswith("//") or any(not "!" <= c <= "~" for c in self.path):
            raise Refusal(400, "the address is none")
        path, _, query = self.path.partition("?")
        if "%" in path or "\\" in path or "/../" in path + "/" or "/./" in path + "/" or "//" in path:
            raise Refusal(404, "there is nothing of that name")
        try:
            said = urllib.parse.parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query), errors="strict", max_num_fields=20)
        except ValueError as error:
            raise Refusal(400, "what stands behind ? cannot be understood") from error
        if len({name for name, _ in said}) != len(said):
            raise Refusal(400, "something is said twice behind ?")
        return path, dict(said)

    # Who.

    def _takes_token(self, path: str, query: Dict[str, str]) -> bool:
        """The address with the token becomes a cookie, and leaves the address bar."""
        if path != "/" or "token" not in query or self.command not in ("GET", "HEAD"):
            return False
        if not self.server.token.is_token(query["token"]):
            raise Refusal(401, "that token is not the one of this shop; use the address that `voxtone serve` printed")
        self.send_response(303)
        self.send_header("Location", "/")
        self.send_header("Set-Cookie", f"{self.server.cookie_name}={self.server.token.cookie}; HttpOnly; SameSite=Strict; Path=/; "
                                       "Max-Age=31536000")
        self.send_header("Content-Length", "0")
        self._guard_headers(_page_policy)
        self.end_headers()
        return True

    def _check_who(self) -> None:
        said = self.headers.get("Authorization", "")
        if said:
            self.by_token = said.startswith("Bearer ") and self.server.token.is_token(said[7:].strip())
            if self.by_token:
                return
            raise Refusal(401, "that token is not the one of this shop")
        if not self.server.token.is_cookie(self._cookie()):
            raise Refusal(401, "open the address with the token that `voxtone serve` printed; programs send it as "
                               "\"Authorization: Bearer TOKEN\"")

    def _cookie(self) -> str:
        try:
            cookies: SimpleCookie[str] = SimpleCookie(self.headers.get("Cookie", ""))
        except CookieError:
            return ""
        return cookies[self.server.cookie_name].value if self.server.cookie_name in cookies else ""

    def _check_origin(self) -> None:
        """Of what changes something, from a browser: this page, and no other. Programs, which say the token, have none."""
        origin, site = self.headers.get("Origin"), self.headers.get("Sec-Fetch-Site", "same-origin")
        if origin is None and self.by_token:
            return
        if origin is None or site != "same-origin" or not self._is_own(origin):
            raise Refusal(403, "only the page of this service may ask for that")

    def _is_own(self, origin: str) -> bool:
        scheme, _, host = origin.lower().partition("://")
        return scheme in ("http", "https") and host == self.headers.get("Host", "").lower()

    # Bodies.

    def read_body(self, most: int, chunk: int = 1 << 18) -> Iterable[bytes]:
        """In pieces; who sends slower than a modem is not waited for."""
        if self.body_left > most:
            raise Refusal(413, f"{bytes_text(self.body_left)} are more than the {bytes_text(most)} that are taken here")
        if self.headers.get("Expect", "").lower() == "100-continue":
            self.send_response_only(100)
            self.end_headers()
        begin, taken = time.monotonic(), 0
        while self.body_left:
            try:
                data = self.rfile.read1(min(self.body_left, chunk))  # type: ignore[attr-defined]
            except socket.timeout as error:
                raise Refusal(408, "the rest of the body did not come") from error
            if not data:
                raise Refusal(400, "the body ended before its length")
            self.body_left -= len(data)
            taken += len(data)
            if taken < (time.monotonic() - begin - 60) * self.server.limits.slowest_bytes_s:
                raise Refusal(408, "the body comes too slowly")
            yield data

    def handle_expect_100(self) -> bool:
        return True  # asked for in read_body, once it is known that the body is wanted

    def content_type(self) -> str:
        return self.headers.get("Content-Type", "").split(";")[0].strip().lower()

    def json_body(self) -> Dict[str, Any]:
        if self.content_type() != "application/json":
            raise Refusal(415, "say it as JSON, with Content-Type: application/json")
        data = b"".join(self.read_body(self.server.limits.text_bytes))
        value = json_of(data or b"{}", "the body")
        if not isinstance(value, dict):
            raise Refusal(400, "the body is an object")
        return value

    # Answers.

    def _guard_headers(self, policy: str) -> None:
        self.send_header("Content-Security-Policy", policy)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.send_header("Cross-Origin-Opener-Policy", "same-origin")

    def begin_answer(self, status: int, kind: str, length: Optional[int], more: Optional[Dict[str, str]] = None,
                     policy: str = _page_policy) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        if length is None:
            self.close_connection = True
            self.send_header("Connection", "close")
        else:
            self.send_header("Content-Length", str(length))
        self._guard_headers(policy)
        for name, value in {"Cache-Control": "no-store", **(more or {})}.items():
            self.send_header(name, value)
        self.end_headers()

    def send_bytes(self, data: bytes, kind: str, status: int = 200, more: Optional[Dict[str, str]] = None,
                   policy: str = _page_policy) -> None:
        self.begin_answer(status, kind, len(data), more, policy)
        if self.command != "HEAD":
            self.wfile.write(data)

    def send_json(self, value: Any, status: int = 200) -> None:
        self.send_bytes(json.dumps(value, separators=(",", ":")).encode(), "application/json", status)

    def refuse(self, refusal: Refusal) -> None:
        if self.body_left or refusal.status in (400, 408, 413, 421):
            self.close_connection = True
        data = json.dumps({"error": refusal.sentence}).encode()
        more = {"Connection": "close"} if self.close_connection else {}
        try:
            self.send_bytes(data, "application/json", refusal.status, more)
            if self.close_connection:
                self._linger()
        except OSError:
            self.close_connection = True

    def _linger(self) -> None:
        """What is on its way is taken for a moment, so that who sends gets to read the answer."""
        self.wfile.flush()
        self.connection.shutdown(socket.SHUT_WR)
        until, most = time.monotonic() + 2, 1 << 22
        while most > 0 and (left := until - time.monotonic()) > 0:
            self.connection.settimeout(left)
            data = self.connection.recv(1 << 16)
            if not data:
                return
            most -= len(data)

    def send_error(self, code: int, message: Optional[str] = None, explain: Optional[str] = None) -> None:
        """What http.server refuses by itself, said our way."""
        self.close_connection = True
        self.request_version = "HTTP/1.0"  # it has a head, whatever was said
        self.body_left = 0
        sentence = message or _sentences.get(code) or "the request cannot be understood"
        self.refuse(Refusal(code if 400 <= code < 500 else 400, sentence))

    def version_string(self) -> str:
        return "voxtone"

    def log_message(self, format: str, *arguments: Any) -> None:  # pylint: disable=redefined-builtin
        """Addresses have names of files, and may have tokens: they are not written down."""


_sentences = {405: "there is no such method here; GET, POST and DELETE are"}
