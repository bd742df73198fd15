"""What the database tells Prometheus: how many stories are in which state, and how long their stages take."""

from __future__ import annotations

from collections.abc import Iterator

from prometheus_client.core import GaugeMetricFamily, SummaryMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector
from sqlalchemy import Engine, func, select
from sqlalchemy.exc import SQLAlchemyError

from planner_service.jobs.queue import Jobs
from planner_service.store.tables import stage_times


class StoreFigures(Collector):
    """Read whenever somebody asks, so that they hold for all workers on all machines, and after any restart."""

    def __init__(self, engine: Engine, jobs: Jobs) -> None:
        self.engine, self.jobs = engine, jobs

    def describe(self) -> Iterator[Metric]:
        """Nothing beforehand: the registry need not ask the database for names."""
        return iter(())

    def collect(self) -> Iterator[Metric]:
        """Figures of this moment; a database that is away is a figure too."""
        up = GaugeMetricFamily("sims_database_up", "Whether the database answers.")
        try:
            found = [self._stories(), self._stages()]
        except SQLAlchemyError:
            up.add_metric([], 0)
            yield up
            return
        up.add_metric([], 1)
        yield up
        yield from found

    def _stories(self) -> Metric:
        meaning = "Stories by state; those queued are the depth of the queue."
        stories = GaugeMetricFamily("sims_stories", meaning, labels=["state"])
        for state, count in self.jobs.counts().items():
            stories.add_metric([state], count)
        return stories

    def _stages(self) -> Metric:
        """Segments count one by one."""
        stages = SummaryMetricFamily("sims_stage_seconds", "Seconds of work by what was made.", labels=["made"])
        query = select(stage_times.c.stage, func.sum(stage_times.c.count), func.sum(stage_times.c.seconds))
        with self.engine.connect() as connection:
            for stage, count, seconds in connection.execute(query.group_by(stage_times.c.stage)):
                stages.add_metric([stage], count_value=int(count), sum_value=float(seconds))
        return stages
