"""Where the database is, by settings of every kind: found where it was meant, or refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest
from for_each import for_each
from service_app import parts_on

from motion_backend.body import character_mesh
from planner_service.server import environment, warm_up
from planner_service.settings import Settings, SettingsError, read_settings
from planner_service.store.database import database_url
from planner_service.themes import lexicon


def test_words_are_known_and_a_body_is_built_before_the_first_visitor_asks() -> None:
    lexicon.kinds_of.cache_clear()
    lexicon._inflected.cache_clear()
    character_mesh._reference_mesh.cache_clear()
    warm_up()
    assert lexicon.kinds_of.cache_info().currsize > 0, "what a word may be: one table"
    assert lexicon._inflected.cache_info().currsize > 0, "and its forms: another"
    assert character_mesh._reference_mesh.cache_info().currsize == 1


@pytest.mark.parametrize("name", ["a b", "größe", "what?now", "100%20", "a#b", "a&b=c;d"])
def test_the_database_lies_in_the_folder_that_was_named_whatever_its_name(tmp_path: Path, name: str) -> None:
    with parts_on(tmp_path / name) as parts:
        assert parts.jobs.counts()["queued"] == 0
    assert [folder.name for folder in tmp_path.iterdir()] == [name]
    assert (tmp_path / name / "sims.db").is_file()


def test_a_worker_gets_the_database_of_its_service_whatever_its_own_env_file_says(tmp_path: Path) -> None:
    settings = Settings(_env_file=None, data_dir=tmp_path / "what?now")
    given = environment(settings, "worker-0")
    theirs = settings.model_copy(update={"database_url": given["SIMS_DATABASE_URL"]})
    assert database_url(theirs) == database_url(settings)


@for_each(
    "url", ["postgresql://a:secret@h:port/x", "mysql://a:secret@h/x", "postgres://a:secret@h/x", "sqlite://", "nothing"]
)
def test_an_address_of_no_database_is_refused_without_its_password(url: str) -> None:
    with pytest.raises(SettingsError, match=r"^SIMS_DATABASE_URL: ") as caught:
        database_url(Settings(_env_file=None, database_url=url))
    assert "postgresql://user:password@host:5432/name" in str(caught.value)
    assert "secret" not in str(caught.value)


@pytest.mark.service
def test_a_database_in_which_the_jobs_may_not_be_kept_is_refused(tmp_path: Path, postgres_url: str) -> None:
    from sqlalchemy import create_engine, make_url, text

    own = make_url(postgres_url)
    engine = create_engine(own.set(drivername="postgresql+psycopg"), isolation_level="AUTOCOMMIT")
    role = f"weak_{own.database}"
    with engine.connect() as connection:
        connection.execute(text(f'CREATE ROLE "{role}" LOGIN'))
        connection.execute(text(f'GRANT ALL ON SCHEMA public TO "{role}"'))
    engine.dispose()
    url = own.set(username=role).render_as_string(hide_password=False)
    with pytest.raises(SettingsError, match="cannot be opened: permission denied for database"):
        parts_on(tmp_path, database_url=url).__enter__()


def test_a_variable_that_is_set_to_nothing_is_not_set(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    names = ("DATA_DIR", "LAYOUTS", "PORT", "LLM_MODEL", "API_KEYS", "WORKERS")
    for name in names:
        monkeypatch.delenv(f"SIMS_{name}", raising=False)
    unset = read_settings()
    for name in names:
        monkeypatch.setenv(f"SIMS_{name}", "")
    assert read_settings() == unset
