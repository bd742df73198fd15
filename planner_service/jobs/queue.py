"""The door to the workers: stories and extractions are queued, cancelled, taken up again; workflows.py makes them."""

from __future__ import annotations

import logging
from typing import Final

from dbos import DBOS, DBOSClient, DBOSPortableJSONSerializer, EnqueueOptions
from sqlalchemy import Connection, Engine, func, select

from planner_service.store.tables import SCHEMA, WAITING, State, state_of, stories, workflow_status

QUEUE: Final = "stories"
WORKFLOW: Final = "act-out"
EXTRACTIONS: Final = "extractions"
"""A queue of their own: a film of two hours holds up no story."""
EXTRACT: Final = "extract"
FILMS: Final = "films"
SHOOT: Final = "shoot"
QUEUES: Final = {WORKFLOW: QUEUE, EXTRACT: EXTRACTIONS, SHOOT: FILMS}
"""Where each kind of work waits."""
APPLICATION: Final = "sims-stories"
VERSION: Final = "1"
"""Raised only when the order of a story's steps changes: stories that an older version began would be left alone."""


class Jobs:
    """Enqueue, cancel and resume stories. Runs none of them."""

    def __init__(self, engine: Engine, url: str) -> None:
        logging.getLogger("dbos").setLevel(logging.ERROR)
        self.engine = engine
        DBOS.migrate(url, schema=SCHEMA)
        self._client = DBOSClient(
            system_database_url=url,
            serializer=DBOSPortableJSONSerializer(),
            application_name=APPLICATION,
            retry_connection_errors=False,
        )

    def enqueue(self, connection: Connection, story_id: str, workflow: str = WORKFLOW, queue: str = QUEUE) -> None:
        """Put a story into the queue within the transaction that makes it: both happen, or neither."""
        options: EnqueueOptions = {
            "workflow_name": workflow,
            "queue_name": queue,
            "workflow_id": story_id,
            "app_version": VERSION,
        }
        self._client.enqueue_in_transaction(connection, options, story_id)

    def cancel(self, story_id: str) -> None:
        """Stop a story before its next step; one that has ended stays as it is."""
        self._wait_for_turn()
        self._client.cancel_workflow(story_id)

    def resume(self, story_id: str) -> None:
        """Let a living worker go on with a story at the step it was in."""
        self._wait_for_turn()
        mine = workflow_status.c.workflow_uuid == story_id
        with self.engine.connect() as connection:
            workflow = connection.execute(select(workflow_status.c.name).where(mine)).scalar()
        self._client.resume_workflow(story_id, queue_name=QUEUES.get(workflow or "", QUEUE))

    def forget(self, story_id: str) -> None:
        """Remove what the job engine knows of a story."""
        self._wait_for_turn()
        self._client.delete_workflow(story_id)

    def _wait_for_turn(self) -> None:
        """Raise OperationalError soon where SQLite is locked: DBOS itself would hold its caller for half a minute."""
        with self.engine.execution_options(writes=True).begin():
            pass

    def unfinished(self, worker: str | None = None) -> list[tuple[str, State, str | None]]:
        """Id, state and worker of every story that has not ended, oldest first; of one worker, those it has begun."""
        columns = (workflow_status.c.workflow_uuid, workflow_status.c.status, workflow_status.c.executor_id)
        query = select(*columns).order_by(workflow_status.c.created_at)
        if worker is None:
            query = query.where(workflow_status.c.status.in_(WAITING))
        else:
            query = query.where(workflow_status.c.status == "PENDING", workflow_status.c.executor_id == worker)
        with self.engine.connect() as connection:
            return [(row[0], state_of(row[1]), row[2]) for row in connection.execute(query)]

    def counts(self) -> dict[State, int]:
        """How many stories are in each state."""
        # A story that was deleted while it was made leaves its job behind.
        there = workflow_status.join(stories, stories.c.id == workflow_status.c.workflow_uuid)
        query = select(workflow_status.c.status, func.count()).select_from(there).group_by(workflow_status.c.status)
        counts: dict[State, int] = dict.fromkeys(("queued", "running", "succeeded", "failed", "cancelled"), 0)
        with self.engine.connect() as connection:
            for status, count in connection.execute(query):
                counts[state_of(status)] += count
        return counts

    def close(self) -> None:
        """Let go of the database."""
        self._client.destroy()
