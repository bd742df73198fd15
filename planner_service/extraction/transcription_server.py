"""Speech to cues by a server that speaks OpenAI's /audio/transcriptions: bounded, patient, never without end."""

from __future__ import annotations

import json
import math
import time
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import Any, Final

import httpx

from planner_service.extraction.audio import SoundPiece, SpeechError, heard
from planner_service.extraction.subtitles import Cue
from planner_service.llm.factory import base_url_of
from planner_service.llm.http_transport import ATTEMPTS, BUSY, FIRST_WAIT, message_of, retry_after, without_key
from planner_service.settings import Settings, SettingsError
from planner_service.user_errors import printable

MAX_ANSWER_BYTES: Final = 1_000_000
"""Bytes of what is heard in a minute."""
_VENDOR: Final = "https://api.openai.com/v1"
_MAX_SEGMENTS: Final = 1000
_REMEDIES: Final = {
    401: "check SIMS_ASR_API_KEY",
    403: "check SIMS_ASR_API_KEY",
    404: "check SIMS_ASR_BASE_URL and SIMS_ASR_MODEL",
    413: "it takes no sound of a minute",
}


@dataclass(frozen=True)
class ServedTranscriber:
    """A server's model; every piece of sound is one request, tried again while the server is busy."""

    base_url: str
    model: str
    key: str = field(default="", repr=False)
    seconds: float = 120.0
    """Of one piece, with all that is tried again."""

    @property
    def name(self) -> str:
        """By the model."""
        return f"asr:{self.model}"

    def transcribe(self, piece: SoundPiece) -> list[Cue]:
        """What is said in a piece, with times of the film. SpeechError."""
        answer = self._carried(piece.wav)
        segments = answer.get("segments")
        if not isinstance(segments, list) or not segments:
            said = answer.get("text", "")
            if not isinstance(said, str):
                raise SpeechError(f"{self.name} answered no text", "check SIMS_ASR_BASE_URL", at="speech")
            return heard(piece, 0.0, piece.end - piece.start, said)
        rows = [(_number(row, "start"), _number(row, "end"), _text(row)) for row in segments[:_MAX_SEGMENTS]]
        return [
            cue
            for start, end, text in rows
            if start is not None and end is not None
            for cue in heard(piece, start, end, text)
        ]

    def _carried(self, wav: bytes) -> dict[str, Any]:
        """One piece's way there and back. SpeechError."""
        deadline = time.monotonic() + self.seconds
        for attempt in range(ATTEMPTS):
            wait = FIRST_WAIT * 2**attempt
            try:
                status, headers, body = self._once(wav, deadline)
            except httpx.HTTPError as error:
                failure = f"it cannot be reached or broke off: {self._shown(str(error) or type(error).__name__)}"
            else:
                if 200 <= status < 300:
                    return self._read(body)
                phrase = HTTPStatus(status).phrase if status in set(HTTPStatus) else "a status of its own"
                failure = f"it answered {status} ({phrase}): {self._shown(message_of(body))}"
                if status not in BUSY:
                    raise SpeechError(
                        f"{self.name}: {failure}; {_REMEDIES.get(status, 'check SIMS_ASR_MODEL')}", at="speech"
                    )
                wait = max(retry_after(headers.get("retry-after", ""), time.time()), wait)
            if time.monotonic() + wait >= deadline:
                raise SpeechError(f"{self.name}: {failure}; its {self.seconds:g} s are over", at="speech")
            if attempt + 1 < ATTEMPTS:
                time.sleep(wait)
        raise SpeechError(f"{self.name}: {failure}; tried {ATTEMPTS} times", at="speech")

    def _once(self, wav: bytes, deadline: float) -> tuple[int, httpx.Headers, bytes]:
        """One exchange; the body is read up to a bound, and not for ever."""
        left = max(0.1, deadline - time.monotonic())
        fields = {"model": self.model, "response_format": "verbose_json", "temperature": "0"}
        headers = {"Accept-Encoding": "identity"} | ({"Authorization": f"Bearer {self.key}"} if self.key else {})
        files = {"file": ("sound.wav", wav, "audio/wav")}
        body = bytearray()
        with (
            httpx.Client(timeout=left, trust_env=False) as client,
            client.stream(
                "POST", f"{self.base_url}/audio/transcriptions", data=fields, files=files, headers=headers
            ) as response,
        ):
            for chunk in response.iter_raw():
                body += chunk
                if len(body) > MAX_ANSWER_BYTES:
                    raise SpeechError(
                        f"{self.name} sent more than {MAX_ANSWER_BYTES} bytes for a minute of sound", at="speech"
                    )
                if time.monotonic() > deadline:
                    raise SpeechError(f"{self.name} was not done after {self.seconds:g} s", at="speech")
            return response.status_code, response.headers, bytes(body)

    def _read(self, body: bytes) -> dict[str, Any]:
        try:
            answer = json.loads(body)
        except (ValueError, RecursionError):
            answer = None
        if not isinstance(answer, dict):
            raise SpeechError(f"{self.name} answered no JSON object", "check SIMS_ASR_BASE_URL", at="speech")
        return answer

    def _shown(self, text: str) -> str:
        return printable(without_key(text, self.key), 200)


def served_transcriber(settings: Settings) -> ServedTranscriber:
    """The server that settings name. SettingsError."""
    key = settings.asr_api_key.get_secret_value().strip()
    if not settings.asr_model:
        raise SettingsError("name the model that SIMS_ASR_BASE_URL serves, such as whisper-1", at="SIMS_ASR_MODEL")
    if not all("!" <= letter <= "~" for letter in key):
        raise SettingsError("a key has no blanks and no letters beyond ASCII", at="SIMS_ASR_API_KEY")
    if not key and not settings.asr_base_url:
        raise SettingsError("OpenAI needs a key", "a server of your own needs SIMS_ASR_BASE_URL", at="SIMS_ASR_API_KEY")
    base_url = base_url_of(settings.asr_base_url, "SIMS_ASR_BASE_URL", "SIMS_ASR_API_KEY")
    return ServedTranscriber(base_url or _VENDOR, settings.asr_model, key)


def _number(row: object, name: str) -> float | None:
    value = row.get(name) if isinstance(row, dict) else None
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None


def _text(row: object) -> str:
    value = row.get("text") if isinstance(row, dict) else None
    return value if isinstance(value, str) else ""
