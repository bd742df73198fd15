"""What the database tells Prometheus: how many stories are in which state, and how long their stages take."""

from __future__ import annotations

from collections.abc import Iterator

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, SummaryMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector
from sqlalchemy import Engine, func, select
from sqlalchemy.exc import SQLAlchemyError

from planner_service.jobs.queue import Jobs
from planner_service.store.story_store import MODEL_CALLS, MODEL_TOKENS
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
            found = [self._stories(), *self._stages()]
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

    def _stages(self) -> Iterator[Metric]:
        """Segments count one by one; what was spent on the language model stands beside them."""
        stages = SummaryMetricFamily("sims_stage_seconds", "Seconds of work by what was made.", labels=["made"])
        query = select(stage_times.c.stage, func.sum(stage_times.c.count), func.sum(stage_times.c.seconds))
        with self.engine.connect() as connection:
            rows = {
                row[0]: (int(row[1]), float(row[2])) for row in connection.execute(query.group_by(stage_times.c.stage))
            }
        calls, waited = rows.pop(MODEL_CALLS, (0, 0.0))
        tokens, dollars = rows.pop(MODEL_TOKENS, (0, 0.0))
        for stage, (count, seconds) in rows.items():
            stages.add_metric([stage], count_value=count, sum_value=seconds)
        yield stages
        meaning = "Seconds that stories waited for the language model, by question."
        yield SummaryMetricFamily("sims_model_seconds", meaning, calls, waited)
        yield CounterMetricFamily("sims_model_tokens", "Tokens that stories spent on the language model.", tokens)
        yield CounterMetricFamily("sims_model_dollars", "What these cost, where a price is set.", dollars)
