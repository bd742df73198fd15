"""The HTTP service: one folder a resource, each with endpoints, schemas and, where they differ, views."""
