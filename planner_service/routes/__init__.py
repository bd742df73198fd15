"""The calls of the HTTP service: one module a resource, each with a `router`."""
