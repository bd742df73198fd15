"""What travels over HTTP, as pydantic models: one module a resource."""
