"""Settings, read once at the entry point: environment variables or a `.env` file with the prefix SIMS_."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from platformdirs import user_data_path
from pydantic import Field, SecretStr, ValidationError, field_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

from scene_graphs.errors import UserError

MIN_KEY = 16
"""Letters of an API key: shorter ones can be guessed."""
Words = Annotated[tuple[str, ...], NoDecode]
"""Words parted by commas."""


class SettingsError(UserError):
    """An environment variable or a line of `.env` that cannot be used."""


class Settings(BaseSettings):
    """Everything that may differ between installations; command-line options mirror it."""

    model_config = SettingsConfigDict(env_prefix="SIMS_", env_file=".env", env_ignore_empty=True, extra="ignore")

    data_dir: Path = Field(default_factory=lambda: user_data_path("sims"))
    """Holds the SQLite database, the cache of sentence features, and films until they have been read."""
    database_url: str = ""
    """PostgreSQL, as postgresql://user:password@host/name; empty for the SQLite file in `data_dir`."""
    backend: str = "procedural"
    """What moves the body where a request names nothing else."""
    clips: Path | None = None
    """A collection of clips (`sims clips build`), whose walks the backend `matching` is made of."""
    physics_seconds: float = Field(3600.0, gt=0, allow_inf_nan=False)
    """How long a story may be simulated by the backend `physics`; what comes after is kinematic."""
    physics_threads: int = Field(0, ge=0, le=1024)
    """On how many threads it linearises; 0: as many as there are processors."""
    physics_mode: Literal["mpc", "policy"] = "mpc"
    """Who controls a simulated body: model-predictive control, or policies where one has passed its bar."""
    physics_policies: Path | None = None
    """A folder of weights (`sims train physics`); left out: those that are shipped."""
    layouts: Path | None = None
    """An extra layout file, read beside the built-in library."""
    llm_model: str = ""
    """The language model that plans and tells, such as "openai:gpt-5" or "ollama:qwen3"; empty for rules."""
    llm_base_url: str = ""
    """Where a server of one's own answers, such as http://127.0.0.1:8080/v1; empty for the vendor's."""
    llm_api_key: SecretStr = SecretStr("")
    llm_on_failure: Literal["rules", "error"] = "rules"
    """What happens where the model gives no usable answer: the rules do it, or the story fails and says why."""
    llm_temperature: float = Field(0.0, ge=0, le=2)
    """How freely the model chooses its words, where it can be told: 0 is the likeliest word every time."""
    llm_timeout: float = Field(120.0, gt=0, le=3600)
    """Seconds of one question, with all that is tried again."""
    llm_answer_tokens: int = Field(16_384, ge=256, le=1_000_000)
    """The longest answer, with the thoughts before it."""
    llm_story_tokens: int = Field(200_000, ge=1)
    llm_story_seconds: float = Field(900.0, gt=0, allow_inf_nan=False)
    llm_story_dollars: float | None = Field(None, gt=0, allow_inf_nan=False)
    """What one story may spend on the model; needs `llm_price`."""
    llm_price: str = Field("", pattern=r"^(\d{1,6}(\.\d{1,6})?/\d{1,6}(\.\d{1,6})?)?$")
    """Dollars a million tokens read, and a million written: "1.25/10"."""
    llm_cache_mb: int = Field(64, ge=0, le=100_000)
    """Answers kept on disk; 0 keeps none."""
    prompts: Path | None = None
    """A folder with prompts of your own, NAME.md, in place of those of the same name."""
    ollama_url: str = "http://127.0.0.1:11434"
    """Where `sims story` and `sims models list` look for an Ollama server; "none" looks nowhere."""
    asr_model: str = ""
    """The model that turns a film's speech into words, such as "whisper-1"; empty for none."""
    asr_base_url: str = ""
    """Where a server of one's own turns speech into words, such as http://127.0.0.1:8001/v1; empty for OpenAI's."""
    asr_api_key: SecretStr = SecretStr("")
    asr_folder: Path | None = None
    """A folder with a faster-whisper model, used instead of a server."""
    host: str = "127.0.0.1"
    port: int = Field(8000, ge=0, le=65535)
    workers: int = Field(1, ge=0, le=64)
    """Worker processes that `sims serve` keeps running; 0 leaves the work to `sims worker` elsewhere."""
    worker_id: str = Field("worker-0", pattern=r"^[a-z0-9][a-z0-9_-]{0,62}$")
    """The name of a worker process; after a crash it goes on with the stories it had under this name."""
    api_keys: Words = ()
    """Keys of those who may use the service; needed to serve beyond this machine."""
    cors_origins: Words = ()
    """Origins of other web pages that may call the service, such as https://studio.example."""
    log_level: Literal["debug", "info", "warning", "error"] = "info"
    most_stories: int = Field(100, ge=1)
    """Stories of one caller that may wait or be in the making at the same time."""
    upload_mb: int = Field(2048, ge=1, le=1_000_000)
    """Megabytes of a film that short scripts are extracted from."""
    rate: str = Field("6000/minute", pattern=r"^[1-9]\d{0,6}/(second|minute|hour)$")
    """Requests of one caller."""

    @field_validator("api_keys", "cors_origins", mode="before")
    @classmethod
    def _words(cls, value: object) -> object:
        if isinstance(value, str):
            return tuple(word.strip() for word in value.split(",") if word.strip())
        return value

    @field_validator("api_keys")
    @classmethod
    def _long(cls, keys: tuple[str, ...]) -> tuple[str, ...]:
        if any(len(key) < MIN_KEY for key in keys):
            raise ValueError(f"a key has at least {MIN_KEY} letters; `openssl rand -hex 24` makes a good one")
        return keys

    @field_validator("backend")
    @classmethod
    def _registered(cls, name: str) -> str:
        from motion_backend.backends import UnknownBackendError, require_backend

        try:
            require_backend(name)
        except UnknownBackendError as error:
            raise ValueError(error.said) from error
        return name

    @field_validator("log_level", mode="before")
    @classmethod
    def _lower(cls, value: object) -> object:
        return value.lower() if isinstance(value, str) else value

    @property
    def database_file(self) -> Path:
        """The SQLite database, where no other is named."""
        return self.data_dir.absolute() / "sims.db"

    @property
    def uploads_dir(self) -> Path:
        """Films and texts that are waiting to be read; shared by all machines that have workers."""
        return self.data_dir.absolute() / "uploads"

    @property
    def cache_dir(self) -> Path:
        """Derived files that may be deleted at any time."""
        return self.data_dir / "cache"


def give_backends(settings: Settings) -> None:
    """Tell the backends of this process the files that they work by, and how long they may."""
    from motion_backend.backends import MATCHING, give_file
    from motion_backend.physics.physics_options import Mode, PhysicsOptions, give_physics

    give_file(MATCHING, settings.clips)
    seconds, threads = settings.physics_seconds, settings.physics_threads
    give_physics(PhysicsOptions(seconds, threads, Mode(settings.physics_mode), settings.physics_policies))


def read_settings(**options: object) -> Settings:
    """The settings of this process; `options` that are not None come before the environment.

    SettingsError names the one that cannot be used.
    """
    try:
        return Settings(**{name: value for name, value in options.items() if value is not None})  # type: ignore[arg-type]
    except ValidationError as error:
        faults = [f"SIMS_{'.'.join(map(str, fault['loc'])).upper()}: {fault['msg']}" for fault in error.errors()]
        raise SettingsError("; ".join(faults)) from error
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f".env cannot be read: {error}", "it must be UTF-8 text") from error
