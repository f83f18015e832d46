"""The extension module: the commands, on the words of a command line."""

from collections.abc import Callable, Sequence
from typing import Optional, TypedDict

__all__ = [
    "TruepathError",
    "__version__",
    "correct",
    "demo",
    "identify",
    "inspect",
    "keep",
    "learn",
    "plan",
    "program_name",
    "read",
    "save",
    "simulate",
]
__version__: str

class TruepathError(Exception):
    code: str
    file: Optional[str]
    line: Optional[int]
    column: Optional[int]
    hint: Optional[str]

class _Given(TypedDict):
    hidden: list[str]
    millimetres: bool
    progress: Optional[Callable[[float], object]]

def program_name(toml: str) -> Optional[str]: ...
def read(job: str, hidden: Sequence[str]) -> str: ...
def correct(words: Sequence[str], given: _Given) -> None: ...
def learn(words: Sequence[str], given: _Given) -> None: ...
def plan(words: Sequence[str], given: _Given) -> None: ...
def keep(job: str, store: str, folder: str, by: str) -> list[str]: ...
def simulate(words: Sequence[str], given: _Given) -> None: ...
def inspect(words: Sequence[str], given: _Given) -> str: ...
def identify(words: Sequence[str], given: _Given) -> str: ...
def demo(words: Sequence[str], given: _Given) -> None: ...
def save(folder: str, files: Sequence[tuple[str, bytes]], force: bool) -> None: ...
