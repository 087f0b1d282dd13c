# SPDX-License-Identifier: GPL-3.0-or-later
"""A client of the Model Context Protocol, scripted."""
import base64
import json
import subprocess
import sys
import time
from pathlib import Path

import pytest

from conftest import box


class Client:
    def __init__(self):
        self.server = subprocess.Popen([sys.executable, "-m", "voxtone.mcp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                       text=True)
        self.count = 0

    def say(self, text):
        self.server.stdin.write(text + "\n")
        self.server.stdin.flush()

    def ask(self, method, **params):
        self.count += 1
        self.say(json.dumps({"jsonrpc": "2.0", "id": self.count, "method": method, "params": params}))
        answer = json.loads(self.server.stdout.readline())
        assert answer["jsonrpc"] == "2.0" and answer["id"] == self.count
        return answer

    def call(self, tool, **arguments):
        return self.ask("tools/call", name=tool, arguments=arguments)["result"]

    def told(self, tool, **arguments):
        result = self.call(tool, **arguments)
        assert not result["isError"], result
        return json.loads(result["content"][0]["text"])


@pytest.fixture
def client():
    client = Client()
    yield client
    client.server.stdin.close()
    assert client.server.wait(180) == 0
    client.server.stdout.close()


def test_a_message_that_is_none_ends_nothing(client):
    for text in ('{"id": 1, "method": "tools/call", "params": [1]}', '{"id": 1, "method": "tools/call", "params": {"name": []}}',
                 '{"id": 1, "method": "initialize", "params": "x"}', '{"id": 1, "method": []}', '[]', '{"id": 1, "method": "ping", '
                 '"params": {"arguments": [2]}}', '{"id": 1, "method": "tools/call", "params": {"name": "list", "arguments": 3}}'):
        client.say(text)
        assert "error" in json.loads(client.server.stdout.readline()), text
    assert client.ask("ping")["result"] == {}


def test_a_session(client, tmp_path):
    began = client.ask("initialize", protocolVersion="2024-11-05")["result"]
    assert began["protocolVersion"] == "2024-11-05"
    package = Path(__file__).resolve().parents[1] / "pyproject.toml"
    assert f'version = "{began["serverInfo"]["version"]}"\n' in package.read_text()
    client.say(json.dumps({"jsonrpc": "2.0", "method": "notifications/initialized"}))
    tools = {tool["name"]: tool for tool in client.ask("tools/list")["result"]["tools"]}
    schema = tools["slice"]["inputSchema"]
    assert schema["required"] == ["model", "out"]
    assert schema["properties"]["quality"]["enum"] == ["draft", "good", "best"]
    assert schema["properties"]["report"]["type"] == "boolean"
    listed = client.told("list")
    assert listed["printers"] and listed["resin_sets"]

    model, out = tmp_path / "box.glb", str(tmp_path / "out")
    box().write(model)
    assert client.told("estimate", model=[str(model)], quick=True)["layers"] > 50
    client.told("slice", model=[str(model)], out=out, quality="draft", predict="transport")
    while not (status := client.told("status", out=out))["done"]:
        time.sleep(0.2)
    assert status["ended"] == "well"
    verdict = client.told("verdict", out=out)
    assert verdict["layers"] > 50 and verdict["resins"]
    content = client.call("picture", out=out)["content"]
    assert [part["text"] for part in content if part["type"] == "text"] [:2] == ["target", "predicted"]
    starts = {"image/webp": b"RIFF", "image/png": b"\x89PNG"}
    for part in content:
        if part["type"] == "image":
            assert base64.b64decode(part["data"]).startswith(starts[part["mimeType"]])


def test_mistakes_are_answered(client, tmp_path):
    client.say("no json")
    assert json.loads(client.server.stdout.readline())["error"]["code"] == -32700
    client.say("[]")
    assert json.loads(client.server.stdout.readline())["error"]["code"] == -32600
    assert client.ask("nonsense")["error"]["code"] == -32601
    assert client.ask("tools/call", name="nonsense")["error"]["code"] == -32601
    for tool, arguments, word in [("verdict", {"out": str(tmp_path)}, "manifest.json"),
                                  ("status", {"out": str(tmp_path)}, "no job was started"),
                                  ("estimate", {"model": ["/nowhere.obj"]}, "/nowhere.obj"),
                                  ("estimate", {"model": ["/nowhere.obj"]}, "/nowhere.obj"),
                                  ("slice", {"out": "x", "sise": 1}, "did you mean size"), ("slice", {}, "out")]:
        result = client.call(tool, **arguments)
        assert result["isError"] and word in result["content"][0]["text"], (tool, result)
    assert client.ask("ping")["result"] == {}
