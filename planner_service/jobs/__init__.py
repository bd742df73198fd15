"""Stories and extractions as durable work: queue, stages, workers."""
