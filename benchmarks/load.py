"""A load from a process of its own: `python -m benchmarks.load URL SECONDS THREADS PAUSE PATH…` prints latencies."""

from __future__ import annotations

import http.client
import json
import sys
import threading
import time
from urllib.parse import urlsplit


def hammer(url: str, paths: list[str], until: float, pause: float, taken: list[float]) -> None:
    """Ask for one path after the other on one connection, and note the seconds of each answer."""
    where = urlsplit(url)
    connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
    turn = 0
    while time.perf_counter() < until:
        started = time.perf_counter()
        connection.request("GET", paths[turn % len(paths)])
        answer = connection.getresponse()
        answer.read()
        taken.append(time.perf_counter() - started)
        if answer.status != 200:
            raise RuntimeError(f"{paths[turn % len(paths)]} answered {answer.status}")
        turn += 1
        time.sleep(pause)
    connection.close()


def main() -> None:
    """Load, then print {"seconds": [...], "wall": …} as JSON."""
    url, seconds, threads, pause, *paths = sys.argv[1:]
    taken: list[list[float]] = [[] for _ in range(int(threads))]
    started = time.perf_counter()
    until = started + float(seconds)
    # Every thread begins elsewhere, so that they do not ask for the same thing at the same moment.
    orders = [paths[n % len(paths) :] + paths[: n % len(paths)] for n in range(len(taken))]
    crew = [
        threading.Thread(target=hammer, args=(url, order, until, float(pause), own))
        for order, own in zip(orders, taken, strict=True)
    ]
    for one in crew:
        one.start()
    for one in crew:
        one.join()
    print(json.dumps({"seconds": sorted(one for own in taken for one in own), "wall": time.perf_counter() - started}))


if __name__ == "__main__":
    main()
