"""Results that nobody overwrites: tables that survive an interruption at any moment, and the loop that fills them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Generic, TypeVar

from tqdm import tqdm

from .errors import ZSpringError
from .interrupt import Interrupted, stop_on_interrupt
from .tables import TableFile, read_rows, write_table

T = TypeVar("T")

REMEDY = "remove it, or give another --output"
LONGEST_SHOWN = 80  # characters of a setting


class Record(Generic[T]):
    """Results by row of a CSV file; a context manager, within which `append` keeps a result on disk at once.

    path        of the file
    head        all settings
    columns     names of the columns
    to_row      the cells of a result
    from_row    the result of a row, by column; raises KeyError, TypeError or ValueError for one that is none
    Raises ZSpringError for a file there that has another head (but for the date), or that is not as it was written:
    nobody's results are overwritten.
    """

    def __init__(
        self,
        path: Path,
        head: Mapping[str, str],
        columns: Sequence[str],
        to_row: Callable[[T], Iterable[object]],
        from_row: Callable[[Mapping[str, str]], T],
    ):
        self.path, self.head, self.columns = path, dict(head), list(columns)
        self._to_row = to_row
        self.results: list[T] = []  # in the order they were kept
        if path.exists():
            found, rows = read_rows(path)
            keep_others(path, self.head, found)
            try:
                self.results = [from_row(row) for row in rows]
            except (KeyError, TypeError, ValueError):
                raise ZSpringError(f"{path}: is not as it was written: {REMEDY}") from None

    def __enter__(self) -> Record[T]:
        self.write(self.results)
        self._file = TableFile(self.path, self.columns, digits=None).__enter__()
        return self

    def append(self, result: T) -> None:
        """Keep a result."""
        self.results.append(result)
        self._file.write(self._to_row(result))

    def __exit__(self, *_) -> None:
        self._file.__exit__()

    def write(self, results: Iterable[T]) -> None:
        """The whole file anew, with these results in this order."""
        self.results = list(results)
        write_table(self.path, self.head, self.columns, map(self._to_row, self.results), digits=None)


def fill(
    record: Record[T],
    total: int | None,
    missing: int,
    what: str,
    work: Callable[[threading.Event], Iterator[T]],
    label: str | None = None,
) -> float:
    """Do what is missing, with a progress bar, each result into the record at once; the seconds it took.

    total, missing      number of results, in all and still to come; a total of None is not known before
    what                their name, in the plural
    work                results as they come, until the event is set
    Raises Interrupted after Ctrl-C; a ZSpringError of the work says what is kept.
    """
    done, of, begin = 0, "", time.perf_counter()
    if total is not None:
        done, of = total - missing, f" of {total}"
        if 0 < missing < total:
            print(f"going on after {done}{of} {what} in {record.path}")
    kept = f"kept in {record.path}; the same command goes on from there"
    bar = tqdm(total=total, initial=done, desc=label, unit=f" {what}", disable=None)
    with stop_on_interrupt() as stop, ExitStack() as stack, bar:
        try:
            for number, result in enumerate(work(stop)):
                if number == 0:  # not before, for work that cannot begin leaves all as it was
                    stack.enter_context(record)
                record.append(result)
                done += 1
                bar.update()
        except ZSpringError as error:
            if not done:
                raise
            raise type(error)(f"{error}; {done}{of} {what} are {kept}") from None
    if stop.is_set() and (total is None or done < total):
        raise Interrupted(f"interrupted after {done}{of} {what}, {kept}")
    return time.perf_counter() - begin


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """The folder, made if need be, for one run at a time. Raises ZSpringError where another one is under way."""
    from filelock import FileLock, Timeout

    made = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    lock = FileLock(folder / ".zspring.lock")
    try:
        lock.acquire(timeout=0)
    except Timeout:
        raise ZSpringError(f"{folder}: another run writes there: wait for its end, or give another --output") from None
    try:
        yield
    finally:
        lock.release()
        with suppress(OSError):
            Path(lock.lock_file).unlink()
            for path in made:
                path.rmdir()  # where nothing was written


def keep_others(path: Path, head: Mapping[str, str], found: Mapping[str, str] | None = None) -> None:
    """To call before work whose results go to `path`. The same settings may come again.

    found   head of the file that is there; None: that of the table
    Raises ZSpringError for a file there of other settings, by its head but for the date.
    """
    if path.exists() and (differs := _difference(read_rows(path)[0] if found is None else found, head)):
        raise ZSpringError(f"{path} is of other settings ({differs}): {REMEDY}")


def _difference(there: Mapping[str, str], here: Mapping[str, str]) -> str:
    """The first key, but the date, in which two heads differ, with both values; empty where none does."""
    for key in (key for key in [*here, *there] if key != "date"):
        before, now = there.get(key), here.get(key, "").strip()
        if before != now:
            shown = _shown(before or "none", now or "none")
            return f"{key}: {shown[0]}, now {shown[1]}"
    return ""


def _shown(before: str, now: str) -> tuple[str, str]:
    """Both texts; of long ones what is near to their first difference."""
    alike = next((i for i, (a, b) in enumerate(zip(before, now)) if a != b), min(len(before), len(now)))
    is_long = max(len(before), len(now)) > LONGEST_SHOWN
    begin = max(alike - LONGEST_SHOWN // 4, 0) if is_long else 0

    def cut(text: str) -> str:
        end = begin + LONGEST_SHOWN
        return f"{'... ' * (begin > 0)}{text[begin:end]}{' ...' * (len(text) > end)}"

    return cut(before), cut(now)
