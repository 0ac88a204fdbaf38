"""A server on this machine that notes who connects to it, and answers nobody."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["listening"]


@contextmanager
def listening() -> Iterator[tuple[str, list[Any]]]:
    """The address of the server, and the peers that have connected to it."""
    made: list[Any] = []
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            while True:
                try:
                    connection, peer = server.accept()
                except OSError:
                    return
                made.append(peer)
                connection.close()

        threading.Thread(target=serve, daemon=True).start()
        yield f"http://127.0.0.1:{server.getsockname()[1]}/", made
        server.shutdown(socket.SHUT_RDWR)
