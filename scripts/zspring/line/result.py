"""The result of a run along a line, and its files: CSV or Parquet, units in the names of the columns."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import ZSpringError, missing_extra
from ..tables import read_table, write_table
from .series import Series
from .stated import UNDISTURBED, Stated

SLIPPING = 0.99  # share of Mf from which a joint counts as slipping; the tanh law creeps below it
_SUPPORT = re.compile(r"support uplift at (\S+) m")
_POINT = re.compile(r"uplift at (\S+) m")


@dataclass(frozen=True)
class LineResult:
    """n communication points, p pantographs, s supports inside the line."""

    time: np.ndarray  # (n,) s
    position: np.ndarray  # (n, p) m along the line
    contact_force: np.ndarray  # (n, p) N
    wire_height: np.ndarray  # (n, p) m, 0 at a dropper without sag
    head_height: np.ndarray  # (n, p) m, head.z where the wire's heights are measured from
    support_position: np.ndarray  # (s,) m along the line
    support_uplift: np.ndarray  # (n, s) m
    slack_droppers: np.ndarray  # (n,)
    moment: np.ndarray  # (n, p, 2) N.m, friction moments of the Z-spring's joints alpha and beta
    settings: dict[str, str]  # all that it takes to repeat the run
    elapsed: float  # s of CPU
    points: Mapping[float, np.ndarray] = field(default_factory=dict)  # (n,) m, uplift of the wire by position in m

    @property
    def friction_bound(self) -> np.ndarray:
        """Mf of each pantograph, N.m. (p,)"""
        count = self.position.shape[1]
        return np.array([float(self.settings[f"pantograph {i + 1} zspring.Mf"].split()[0]) for i in range(count)])

    @property
    def undisturbed_until(self) -> np.ndarray:
        """Where each pantograph meets what the far end reflects, m along the line. (p,)"""
        count = self.position.shape[1]
        return np.array([float(self.settings.get(UNDISTURBED.format(i + 1), "inf m").split()[0]) for i in range(count)])

    def series(self, i: int) -> Series:
        """What pantograph i, counted from 0, does along the line, for the statistics."""
        names = [f"support at {position:g} m" for position in self.support_position]
        return Series(
            name=f"pantograph {i + 1}",
            time=self.time,
            force=self.contact_force[:, i],
            position=self.position[:, i],
            height=self.wire_height[:, i],
            uplift=dict(zip(names, self.support_uplift.T)),
            support_position=dict(zip(names, self.support_position.tolist())),
            stated=Stated(undisturbed_until=float(self.undisturbed_until[i])),
            points=self.points,
        )


def columns(result: LineResult) -> dict[str, np.ndarray]:
    """All series by column name, each (n,)."""
    return dict(_columns(result))


def _columns(result: LineResult) -> Iterator[tuple[str, np.ndarray]]:
    yield "time [s]", result.time
    for i in range(result.position.shape[1]):
        yield f"position {i + 1} [m]", result.position[:, i]
        yield f"contact force {i + 1} [N]", result.contact_force[:, i]
        yield f"wire height {i + 1} [m]", result.wire_height[:, i]
        yield f"head height {i + 1} [m]", result.head_height[:, i]
        yield f"moment alpha {i + 1} [N.m]", result.moment[:, i, 0]
        yield f"moment beta {i + 1} [N.m]", result.moment[:, i, 1]
    yield "slack droppers", result.slack_droppers
    for position, uplift in zip(result.support_position, result.support_uplift.T):
        yield f"support uplift at {position:.10g} m [m]", uplift
    for position, uplift in result.points.items():
        yield f"uplift at {position:.10g} m [m]", uplift


def write_result(result: LineResult, path: Path) -> None:
    """Write a .csv or a .parquet file. Raises ZSpringError where pyarrow is missing for the latter."""
    head = {**result.settings, "elapsed": f"{result.elapsed:.3g} s"}
    table = columns(result)
    if path.suffix == ".parquet":
        path.parent.mkdir(parents=True, exist_ok=True)
        _write_parquet(path, head, table)
    else:
        write_table(path, head, list(table), zip(*table.values()), digits=10)


def read_result(path: Path) -> LineResult:
    """Read what `write_result` wrote. Raises ZSpringError for a file of another kind."""
    head, table = _read_parquet(path) if path.suffix == ".parquet" else _read_csv(path)
    try:
        elapsed = float(head.pop("elapsed").split()[0])
        count = sum(name.startswith("position ") for name in table)

        def of_each(name: str) -> np.ndarray:
            return np.column_stack([table[name.format(i + 1)] for i in range(count)])

        uplift = {found[1]: series for name, series in table.items() if (found := _SUPPORT.match(name))}
        points = {float(found[1]): series for name, series in table.items() if (found := _POINT.match(name))}
        return LineResult(
            time=table["time [s]"],
            position=of_each("position {} [m]"),
            contact_force=of_each("contact force {} [N]"),
            wire_height=of_each("wire height {} [m]"),
            head_height=of_each("head height {} [m]"),
            support_position=np.array([float(position) for position in uplift]),
            support_uplift=np.array(list(uplift.values())).T.reshape(len(table["time [s]"]), -1),
            slack_droppers=table["slack droppers"].astype(int),
            moment=np.stack([of_each(f"moment {joint} {{}} [N.m]") for joint in ("alpha", "beta")], axis=2),
            settings=head,
            elapsed=elapsed,
            points=points,
        )
    except (KeyError, ValueError) as error:
        raise ZSpringError(f"{path}: is not as zspring couple writes it: {error} is missing") from None


def _read_csv(path: Path) -> tuple[dict[str, str], dict[str, np.ndarray]]:
    table = read_table(path)
    return dict(table.head), {column.label: table.numbers(name) for name, column in table.columns.items()}


def _arrow():
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise missing_extra(["pyarrow"], "study") from None
    return pyarrow


def _write_parquet(path: Path, head: dict[str, str], table: dict[str, np.ndarray]) -> None:
    arrow = _arrow()
    arrow.parquet.write_table(arrow.table(table).replace_schema_metadata(head), path)


def _read_parquet(path: Path) -> tuple[dict[str, str], dict[str, np.ndarray]]:
    table = _arrow().parquet.read_table(path)
    head = {
        key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items() if key != b"ARROW:schema"
    }
    return head, {name: table[name].to_numpy() for name in table.column_names}
