"""A client of a server process, in place of an editor, for tests and benchmarks."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from onto_compiler.closing import Closing

__all__ = ["Client"]

_PROGRAM = "import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))"


class Client(Closing):
    """A server process and the messages to and from it; ``log`` holds every notification in order.

    ``folder`` is the workspace that the editor has open, and ``capabilities`` are the editor's.
    """

    def __init__(
        self, *arguments: str, folder: Path | None = None, capabilities: Mapping[str, object] | None = None
    ) -> None:
        command = [sys.executable, "-c", _PROGRAM, "lsp", *arguments]
        self.process = subprocess.Popen(  # noqa: S603 - our own program
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        self.log: list[Mapping[str, Any]] = []
        self._number = 0
        self._versions: dict[str, int] = {}
        start: dict[str, object] = {"processId": None, "rootUri": None, "capabilities": capabilities or {}}
        if folder is not None:
            start["workspaceFolders"] = [{"uri": folder.as_uri(), "name": folder.name}]
        self.capabilities = self.request("initialize", start)["capabilities"]
        self.notify("initialized", {})

    def close(self) -> int:
        """End the session as in the protocol; returns the exit code."""
        if self.process.poll() is None:
            self.request("shutdown", None)
            self.notify("exit", None)
        code = self.process.wait(timeout=20)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            if stream is not None:
                stream.close()
        return code

    def request(self, method: str, params: object) -> Any:  # noqa: ANN401 - whatever the method answers
        """Send a request and wait for its result; notifications that come before it are logged."""
        self._number += 1
        self._send({"jsonrpc": "2.0", "id": self._number, "method": method, "params": params})
        while True:
            message = self._receive()
            if message.get("id") == self._number and "method" not in message:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.log.append(message)

    def notify(self, method: str, params: object) -> None:
        """Send a notification."""
        self._send({"jsonrpc": "2.0", "method": method, "params": params})

    def open(self, path: Path, text: str, language: str) -> Sequence[Mapping[str, Any]]:
        """Open a document and wait for the first answer to it."""
        uri = path.as_uri()
        self._versions[uri] = 1
        item = {"uri": uri, "languageId": language, "version": 1, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": item})
        return self.diagnostics(uri)

    def type(self, path: Path, line: int, character: int, text: str, erase: int = 0) -> Sequence[Mapping[str, Any]]:
        """Insert ``text`` at a place (from 0, in UTF-16) in place of ``erase`` units; wait for the first answer."""
        return self.replace(path, (line, character), (line, character + erase), text)

    def replace(
        self, path: Path, start: tuple[int, int], end: tuple[int, int], text: str
    ) -> Sequence[Mapping[str, Any]]:
        """Put ``text`` in the place of what stands from ``start`` to ``end``; wait for the first answer."""
        uri = path.as_uri()
        self._versions[uri] += 1
        first, last = ({"line": line, "character": character} for line, character in (start, end))
        change = {"range": {"start": first, "end": last}, "text": text}
        document = {"uri": uri, "version": self._versions[uri]}
        self.notify("textDocument/didChange", {"textDocument": document, "contentChanges": [change]})
        return self.diagnostics(uri)

    def diagnostics(self, uri: str) -> Sequence[Mapping[str, Any]]:
        """The next diagnostics of the document's present version."""
        while True:
            message = self._receive()
            self.log.append(message)
            params = message.get("params", {})
            wanted = (uri, self._versions[uri])
            if message.get("method") == "textDocument/publishDiagnostics" and wanted == (
                params["uri"],
                params.get("version"),
            ):
                return cast("Sequence[Mapping[str, Any]]", params["diagnostics"])

    def at(self, method: str, path: Path, line: int, character: int) -> Any:  # noqa: ANN401 - as ``ask``
        """Ask something of a place."""
        position = {"line": line, "character": character}
        return self.request(f"textDocument/{method}", {"textDocument": {"uri": path.as_uri()}, "position": position})

    def _send(self, message: Mapping[str, Any]) -> None:
        body = json.dumps(message).encode()
        stream = self.process.stdin
        if stream is None:
            raise RuntimeError("the server has no standard input")
        stream.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        stream.flush()

    def _receive(self) -> Mapping[str, Any]:
        stream = self.process.stdout
        if stream is None:
            raise RuntimeError("the server has no standard output")
        length = 0
        while (line := stream.readline()) not in {b"\r\n", b"\n"}:
            if not line:
                raise RuntimeError("the server ended")
            name, _, value = line.partition(b":")
            length = int(value) if name.lower() == b"content-length" else length
        return cast("Mapping[str, Any]", json.loads(stream.read(length)))
