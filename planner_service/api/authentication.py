"""Who may ask: loopback with Host and Origin checked, bearer keys beyond, and a signed cookie for the page."""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import re
import time
from dataclasses import dataclass, field
from typing import Final, NoReturn
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.middleware.cors import CORSMiddleware
from starlette.requests import cookie_parser
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send
from structlog.contextvars import bind_contextvars

from planner_service.api.errors import Forbidden, Malformed, Problem, Unauthorised
from planner_service.api.rate_limit import Rate, address_of
from planner_service.settings import MIN_KEY, Settings, SettingsError

COOKIE: Final = "sims_session"
COOKIE_SECONDS: Final = 30 * 24 * 3600
LOGINS: Final = "10/minute"
REFUSALS: Final = "600/minute"
WRONG: Final = "this key is not one of the service's"
OPEN: Final = frozenset({"/", "/healthz", "/readyz", "/session", "/openapi.json", "/favicon.ico", "/favicon.svg"})
"""Paths that need no key; the page's own files are open too."""
SAFE: Final = frozenset({"GET", "HEAD", "OPTIONS"})
EXPOSED: Final = ("Location", "ETag", "Retry-After", "Sims-Frames", "Sims-Ready", "Sims-Complete", "X-Request-ID")
HOST: Final = re.compile(r"(?P<name>[A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\])(?::\d{1,5})?\Z")
LOCAL: Final = "local"
"""The caller's name where no keys are set."""


def check_exposure(settings: Settings) -> None:
    """SettingsError where strangers could get in: no keys beyond loopback, weak keys, origins that are none."""
    if not settings.api_keys and not is_loopback(settings.host):
        raise SettingsError(
            f"without keys the service is bound to this machine only, not to {settings.host}",
            "set SIMS_API_KEYS (`openssl rand -hex 24` makes a good key) or SIMS_HOST=127.0.0.1",
            at="SIMS_API_KEYS",
        )
    for key in settings.api_keys:
        if len(key) < MIN_KEY or len(set(key)) < MIN_KEY // 4:
            raise SettingsError("a key can be guessed", f"use {MIN_KEY} or more random letters", at="SIMS_API_KEYS")
        if not key.isascii() or not key.isprintable() or " " in key:
            raise SettingsError("a key travels in a header: printable ASCII letters without spaces", at="SIMS_API_KEYS")
    for origin in settings.cors_origins:
        parts = urlsplit(origin)
        if origin != f"{parts.scheme}://{parts.netloc}" or parts.scheme not in ("http", "https") or "*" in origin:
            raise SettingsError(f"{origin!r:.80} is no origin", "write https://studio.example", at="SIMS_CORS_ORIGINS")


def is_loopback(host: str) -> bool:
    """Whether a name or address, without port, means this machine and nothing else."""
    try:
        return host.lower() == "localhost" or ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def fingerprint(key: str) -> str:
    """What a key's owner is called in tables and logs: tells nothing of the key."""
    return hashlib.sha256(key.encode()).hexdigest()[:12]


@dataclass(frozen=True)
class Gate:
    """The keys there are and the origins that may ask."""

    keys: tuple[str, ...] = ()
    origins: tuple[str, ...] = ()
    refusals: Rate = field(default_factory=lambda: Rate(REFUSALS))
    """By address. Counted, so that strangers cannot keep the service busy; a right key is never kept out by them."""
    logins: Rate = field(default_factory=lambda: Rate(LOGINS))
    """Wrong keys at POST /session, by address."""

    @property
    def locked(self) -> bool:
        """Whether a key is needed."""
        return bool(self.keys)

    def owner(self, given: str) -> str | None:
        """The fingerprint of a key that is right; takes the same time for any that is wrong."""
        digest = hashlib.sha256(given.encode("utf-8", "surrogateescape")).digest()
        found = None
        for key in self.keys:
            if hmac.compare_digest(digest, hashlib.sha256(key.encode()).digest()):
                found = fingerprint(key)
        return found

    def log_in(self, given: str, scope: Scope) -> str | None:
        """A cookie's value for a right key, None where no key is needed.

        Unauthorised for a wrong key; TooMany for any after some wrong ones from the same address.
        """
        if not self.locked:
            return None
        address = address_of(scope)
        self.logins.check(address, "too many wrong keys")
        if self.owner(given) is None:
            self.logins.take(address, "too many wrong keys")
            raise Unauthorised(WRONG)
        return self.cookie(given, int(time.time()) + COOKIE_SECONDS)

    def cookie(self, key: str, expiry: int) -> str:
        """ "expiry.signature"; the key cannot be read from it, and a key that is taken away ends it."""
        signature = hmac.digest(key.encode(), f"sims session until {expiry}".encode(), "sha256").hex()
        return f"{expiry}.{signature}"

    def cookie_owner(self, value: str) -> str | None:
        """The fingerprint of the key that signed a cookie which has not expired."""
        expiry, _, _signature = value.partition(".")
        if not (expiry.isascii() and expiry.isdecimal() and len(expiry) <= 12) or int(expiry) < time.time():
            return None
        found = None
        for key in self.keys:
            if hmac.compare_digest(value.encode("utf-8", "replace"), self.cookie(key, int(expiry)).encode()):
                found = fingerprint(key)
        return found

    def admit(self, scope: Scope) -> str | None:
        """Who asks, None for a stranger at an open path. Problem when the request may not pass."""
        headers = Headers(scope=scope)
        if not self.locked:
            _check_local(headers)
            _check_origin(scope, headers, self.origins)
            return LOCAL
        scheme, _, given = headers.get("authorization", "").partition(" ")
        if scheme.lower() == "bearer":
            return self.owner(given.strip()) or self._refuse(scope, WRONG)
        caller = self.cookie_owner(cookie_parser(headers.get("cookie", "")).get(COOKIE, ""))
        if caller is not None and scope["method"] not in SAFE:
            _check_same_site(headers)
        if caller is None and scope["path"] == "/session":
            _check_origin(scope, headers, ())
        if caller is None and not is_open(scope["path"]):
            self._refuse(scope, "a key is needed: send Authorization: Bearer KEY, or log in with POST /session")
        return caller

    def _refuse(self, scope: Scope, why: str) -> NoReturn:
        self.refusals.take(address_of(scope), "too many requests without a right key")
        raise Unauthorised(why)


def is_open(path: str) -> bool:
    """Whether a path needs no key."""
    return path in OPEN or path.startswith("/assets/")


def _check_local(headers: Headers) -> None:
    """A page elsewhere may point a name of its own at 127.0.0.1; the Host header gives it away."""
    host = headers.get("host", "")
    match = HOST.match(host)
    if match is None or not is_loopback(match["name"]):
        raise Forbidden(
            f"Host {host!r:.80} is not this machine: without keys only localhost, 127.0.0.1 and [::1] are served; "
            "set SIMS_API_KEYS to serve others"
        )


def _check_origin(scope: Scope, headers: Headers, origins: tuple[str, ...]) -> None:
    """A browser says which page asks; only our own and those that were allowed may."""
    origin = headers.get("origin")
    site = headers.get("sec-fetch-site", "none")
    unsafe = scope["method"] not in SAFE
    if origin is None and not (unsafe and site in ("cross-site", "same-site")):
        return
    if origin is None or not (origin in origins or _same_host(origin, headers)):
        shown = f"Origin {origin!r:.80}" if origin else f"Sec-Fetch-Site {site!r:.20}"
        raise Forbidden(f"{shown} is another page; name its origin in SIMS_CORS_ORIGINS to let it in")


def _check_same_site(headers: Headers) -> None:
    """A cookie travels with whatever a browser is made to send, so our own page must be the one that asks."""
    site = headers.get("sec-fetch-site")
    origin = headers.get("origin")
    if not (site == "same-origin" if site else origin is not None and _same_host(origin, headers)):
        raise Forbidden("with the session cookie only the service's own page may change things; others send a key")


def _same_host(origin: str, headers: Headers) -> bool:
    """Schemes are not compared: a proxy in front may have taken the encryption off."""
    scheme, _, host = origin.lower().partition("://")
    return scheme in ("http", "https") and host == headers.get("host", "").lower()


class Access:
    """ASGI: puts the caller's name into `request.state.caller`, or answers why not."""

    def __init__(self, app: ASGIApp, gate: Gate) -> None:
        self.app = app
        self.gate = gate

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on with a caller, or answer 401, 403 or 429."""
        if scope["type"] == "http":
            try:
                caller = self.gate.admit(scope)
            except Problem as problem:
                await problem.response(scope["path"])(scope, receive, send)
                return
            scope.setdefault("state", {})["caller"] = caller
            bind_contextvars(caller=caller)
        await self.app(scope, receive, send)


class Cors(CORSMiddleware):
    """Starlette's, for the calls that our clients make from other origins; refusals are problems too."""

    def __init__(self, app: ASGIApp, origins: tuple[str, ...]) -> None:
        super().__init__(
            app,
            allow_origins=origins,
            allow_methods=("GET", "HEAD", "POST", "DELETE"),
            allow_headers=("Authorization", "Idempotency-Key", "Last-Event-ID", "If-None-Match", "X-Request-ID"),
            expose_headers=EXPOSED,
        )

    def preflight_response(self, request_headers: Headers) -> Response:
        """What a browser asks before it lets a page call us."""
        answer = super().preflight_response(request_headers)
        if answer.status_code == 200:
            return answer
        said = {name: value for name, value in answer.headers.items() if not name.startswith("content-")}
        return Malformed(f"{bytes(answer.body).decode()}; see SIMS_CORS_ORIGINS", headers=said).response("")
