"""Settings, read once at the entry point: environment variables or a `.env` file with the prefix SIMS_."""

from __future__ import annotations

from pathlib import Path

from platformdirs import user_data_path
from pydantic import Field, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict


class SettingsError(ValueError):
    """An environment variable or a line of `.env` that cannot be used."""


class Settings(BaseSettings):
    """Everything that may differ between installations; command-line options mirror it."""

    model_config = SettingsConfigDict(env_prefix="SIMS_", env_file=".env", extra="ignore")

    data_dir: Path = Field(default_factory=lambda: user_data_path("sims"))
    """Holds the user's own short scripts and the cache of sentence features."""
    backend: str = "procedural"
    layouts: Path | None = None
    """An extra layout file, read beside the built-in library."""

    @property
    def scripts_file(self) -> Path:
        """The user's own short scripts."""
        return self.data_dir / "short_scripts.jsonl"

    @property
    def cache_dir(self) -> Path:
        """Derived files that may be deleted at any time."""
        return self.data_dir / "cache"


def read_settings() -> Settings:
    """The settings of this process. SettingsError names the one that cannot be used."""
    try:
        return Settings()
    except ValidationError as error:
        faults = [f"SIMS_{'.'.join(map(str, fault['loc'])).upper()}: {fault['msg']}" for fault in error.errors()]
        raise SettingsError("; ".join(faults)) from error
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f".env cannot be read: {error}; it must be UTF-8 text") from error
