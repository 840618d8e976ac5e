"""An independent overhead line of any kind, from the same table of numbers as the FMU's; nothing else is shared.

Contact wire; messenger and stitch wires as one body. Droppers join the bodies as forces f, found at rest at once, with
lengths as they are:

    0 <= f   complementary to   f / k - (distance of the wires - unstretched length) >= 0
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.sparse import csr_matrix, vstack

from catenary_line import Banded, Line, Wire, complementarity, hermite
from zspring import line_table
from zspring.line_table import LineTable


class Upper:
    """Messenger and stitch wires, tied at the clamps: mass, stiffness, and rows for places on them.

    Each element is a cubic beam or, between the clamps of a stitch wire, if `strings`, a linear string whose mass is
    the mean of the consistent and the lumped one. Degrees of freedom: w and w' by wire and place; w = 0 at anchors.
    """

    def __init__(self, x: np.ndarray, table: LineTable, messenger: tuple[float, float, float], strings: bool):
        mass, tension, bending = messenger
        self.elements, self.numbers = [], {}
        for a, b in itertools.pairwise(x):
            s = next((s for s in table.stitches if s["begin"] <= a < s["end"]), None)
            less = 0.0 if s is None else s["tension"]
            self._element("messenger", a, b, mass, tension - less, bending, strings and s is not None)
            if s is not None:
                ends = ["messenger" if place in (s["begin"], s["end"]) else "stitch" for place in (a, b)]
                self._element("stitch", a, b, s["mass"], s["tension"], 0.0, strings, ends)
        anchors = [self.numbers["messenger", place, "w"] for place in (x[0], x[-1])]
        self.free = np.setdiff1d(np.arange(len(self.numbers)), anchors)
        self.size = len(self.free)
        n = len(self.numbers)
        matrices, weight = np.zeros((2, n, n)), np.zeros(n)
        for _, a, b, m, t, EI, string, dofs in self.elements:
            inertia, stiffness, load = string_element(b - a, m, t) if string else beam_element(b - a, m, t, EI)
            matrices[0][np.ix_(dofs, dofs)] += inertia
            matrices[1][np.ix_(dofs, dofs)] += stiffness
            weight[dofs] += load
        self.mass, self.beam = (csr_matrix(matrix[np.ix_(self.free, self.free)]) for matrix in matrices)
        self.weight = weight[self.free]  # kg

    def _element(self, wire, a, b, mass, tension, bending, string, ends=("messenger", "messenger")) -> None:
        kinds = ("w",) if string else ("w", "slope of " + wire)
        names = [(owner if kind == "w" else wire, place, kind) for owner, place in zip(ends, (a, b)) for kind in kinds]
        dofs = [self.numbers.setdefault(name, len(self.numbers)) for name in names]
        self.elements.append((wire, a, b, mass, tension, bending, string, dofs))

    def _rows(self, dofs) -> csr_matrix:
        return csr_matrix((np.ones(len(dofs)), (range(len(dofs)), dofs)), (len(dofs), len(self.numbers)))[:, self.free]

    def at(self, x, wire: str = "messenger") -> csr_matrix:
        """Rows of places on one of the wires."""
        rows = []
        for place in x:
            element = next(e for e in self.elements if e[0] == wire and e[1] <= place <= e[2])
            _, a, b, *_, string, dofs = element
            share = (place - a) / (b - a)
            rows.append(csr_matrix([1 - share, share] if string else hermite(share, b - a)) @ self._rows(dofs))
        return vstack(rows).tocsr() if rows else csr_matrix((0, self.size))


def string_element(length: float, mass: float, tension: float):
    consistent, lumped = mass * length / 6 * np.array([[2, 1], [1, 2]]), mass * length / 2 * np.eye(2)
    return (consistent + lumped) / 2, tension / length * np.array([[1, -1], [-1, 1]]), mass * length / 2 * np.ones(2)


def beam_element(length: float, mass: float, tension: float, bending: float):
    wire = Wire(np.array([0.0, length]), mass, tension, bending, held=False)
    return wire.mass.toarray(), wire.beam.toarray(), mass * wire.uniform


class AnyLine(Line):
    """`wires`: the FMU's parameters of wires, damping, gravity and mesh by name.

    strings     along a stitch, as the FMU has them; else beams there too, with the messenger's bending stiffness
    """

    def __init__(self, table: LineTable, wires: Mapping[str, float], strings: bool = True):
        self.table, self.given = table, wires
        self.length = float(table.boundaries[-1])
        self.supports, self.droppers = table.boundaries[1:-1], table.droppers["x"]
        self.spans, self.span = len(table.boundaries) - 1, float(table.boundaries[1])
        contact, messenger = (
            tuple(wires[f"{wire}.{name}"] for name in ("mass", "tension", "EI"))
            for wire in ("contact_wire", "messenger")
        )
        x = self._nodes(wires["mesh.element"])
        self.wires = (Wire(x, *contact), Upper(x, table, messenger, strings))
        self._rest(contact[0])
        self._bodies()

    def _nodes(self, element: float) -> np.ndarray:
        t = self.table
        places = [t.boundaries, t.droppers["x"], t.stitches["begin"], t.stitches["end"], t.masses["x"]]
        parts = [
            np.linspace(a, b, int(np.ceil((b - a) / element - 1e-9)) + 1)[:-1]
            for a, b in itertools.pairwise(np.unique(np.concatenate(places)))
        ]
        return np.append(np.concatenate(parts), self.length)

    def _upper_ends(self) -> np.ndarray:
        rows = [self.wires[1].at([d["x"]], "stitch" if d["upper"] else "messenger") for d in self.table.droppers]
        return vstack(rows).toarray().T if rows else np.zeros((self.wires[1].size, 0))

    def _rest(self, contact_mass: float) -> None:
        t, (contact, upper) = self.table, self.wires
        g, drop = self.given["gravity"], t.droppers
        low, high = contact.at(drop["x"]).toarray().T, self._upper_ends()
        at_support = upper.at(self.supports).toarray().T
        masses = {wire: t.masses[t.masses["wire"] == wire] for wire in (0, 1)}
        self.point = contact.point(masses[0]["x"], masses[0]["mass"]), self._upper_points(masses[1])
        on_contact = contact_mass * g * contact.uniform + g * contact.at(masses[0]["x"]).T @ masses[0]["mass"]
        clamps = upper.at(t.stitches["begin"]).T + upper.at(t.stitches["end"]).T
        on_upper = g * (upper.weight + upper.at(masses[1]["x"]).T @ masses[1]["mass"] + clamps @ t.stitches["clamp"])

        def line_between(begin, end):
            return lambda x: begin + (end - begin) * np.asarray(x) / self.length

        level, above = line_between(*t.ends), line_between(t.supports["messenger"][0], t.supports["messenger"][-1])
        self.above = above
        gap = above(drop["x"]) - level(drop["x"])
        solve_c, solve_u = Banded(contact.beam), dense(upper.beam)
        heights = drop["height"] - level(drop["x"])
        at_supports = t.supports["messenger"][1:-1] - above(self.supports)

        def held(solve, load, at, target):
            free = solve(load)
            unit = solve(at) if at.shape[1] else at
            force = np.linalg.solve(at.T @ unit, target - at.T @ free) if at.shape[1] else np.zeros(0)
            return free + unit @ force, force

        # As drawn.
        shape, reaction = held(solve_c, -on_contact, low, heights)
        rope = np.zeros(len(drop))
        for _ in range(100):
            T0 = reaction + g * (drop["clamp_contact"] + rope / 2)
            load = -on_upper - high @ (T0 + g * (drop["clamp_upper"] + rope / 2))
            top, _ = held(solve_u, load, at_support, at_supports)
            distance = gap + high.T @ top - low.T @ shape
            rope = drop["mass"] * distance
        k = np.where(
            drop["EA"] > 0, drop["EA"] / np.where(drop["length"] > 0, drop["length"], distance), drop["stiffness"]
        )
        unstretched = np.where(drop["length"] > 0, drop["length"], distance - T0 / k) + drop["length_error"]
        # With the lengths as they are, all forces at once.
        only_c = solve_c(-on_contact - low @ (g * (drop["clamp_contact"] + rope / 2)))
        only_u, _ = held(solve_u, -on_upper - high @ (g * (drop["clamp_upper"] + rope / 2)), at_support, at_supports)
        y_c = solve_c(low) if len(drop) else low
        y_u = (
            np.column_stack([held(solve_u, column, at_support, 0 * at_supports)[0] for column in high.T])
            if len(drop)
            else high
        )
        f, _ = complementarity(
            np.diag(1 / k) + low.T @ y_c + high.T @ y_u,
            gap + high.T @ only_u - low.T @ only_c - unstretched,
            np.ones(len(drop), bool),
        )
        self.shape, self.messenger_shape = only_c + y_c @ f, only_u - y_u @ f
        self.dropper_length = gap + high.T @ self.messenger_shape - low.T @ self.shape
        self.T0 = k * (self.dropper_length - unstretched)
        self.flexibility, self.rope, self.J = 1 / k, drop["mass"] * self.dropper_length, (low, -high)
        x = contact.x
        nodes = np.column_stack([level(x), np.full(len(x), (t.ends[1] - t.ends[0]) / self.length)])
        self.shape = self.shape + nodes.ravel()[contact.free]  # but for heights of the ends themselves

    def irregularity(self, x) -> np.ndarray:
        p = self.table.profile
        if not len(p):
            return np.zeros(np.shape(x))
        return np.nan_to_num(CubicHermiteSpline(p["x"], p["height"], p["slope"], extrapolate=False)(x))

    def _upper_points(self, masses: np.ndarray):
        rows = self.wires[1].at(masses["x"])
        return rows.T.multiply(masses["mass"]) @ rows if len(masses) else csr_matrix(self.wires[1].beam.shape)

    def _bodies(self) -> None:
        t, (contact, upper), given = self.table, self.wires, self.given
        low, high, inner = self.J[0], -self.J[1], t.supports[1:-1]
        at_support = upper.at(self.supports).toarray().T
        ends = [row.T @ row * s["clamp"] for s in t.stitches for row in upper.at([s["begin"], s["end"]])]
        half = self.rope / 2
        self.M = (
            contact.mass
            + self.point[0]
            + csr_matrix(low * (t.droppers["clamp_contact"] + half) @ low.T)
            + contact.point(self.supports, inner["arm_mass"]),
            csr_matrix(
                upper.mass
                + self.point[1]
                + sum(ends, csr_matrix(upper.beam.shape))
                + csr_matrix(high * (t.droppers["clamp_upper"] + half) @ high.T)
            ),
        )
        self.K = (
            contact.beam + contact.point(self.supports, inner["arm_stiffness"]),
            csr_matrix(upper.beam + csr_matrix(at_support * inner["stiffness"] @ at_support.T)),
        )
        a, b = given["damping.mass"], given["damping.stiffness"]
        self.C = tuple(csr_matrix(a * m + b * w.beam) for m, w in zip(self.M, self.wires))


def dense(matrix):
    inverse = np.linalg.inv(matrix.toarray())
    return lambda right: inverse @ right


# Lines of every kind


def table(supports, droppers=(), stitches=(), masses=(), profile=(), ends=(0.0, 0.0)) -> LineTable:
    """Rows as in the file; a dropper: (x, upper, height) and what of the others is not usual, by name."""
    usual = {"stiffness": 1e5, "mass": 0.117, "clamp_contact": 0.165, "clamp_upper": 0.195}
    hangers = np.zeros(len(droppers), line_table.DROPPER)
    for row, (x, upper, height, *others) in zip(hangers, droppers):
        for name, value in ({"x": x, "upper": upper, "height": height} | usual | (others[0] if others else {})).items():
            row[name] = value
    kinds = line_table.STITCH, line_table.POINT_MASS, line_table.PROFILE
    rest = (np.array(list(rows), kind) for rows, kind in zip((stitches, masses, profile), kinds))
    return LineTable(np.array(list(supports), line_table.SUPPORT), ends, hangers, *rest)


def supported(*x: float, messenger: Callable[[float], float] = lambda x: 1.3, arm=(0.3, 300.0)) -> list[tuple]:
    inner = [(place, messenger(place), 5e5, *arm) for place in x[1:-1]]
    return [(x[0], messenger(x[0]), 0, 0, 0), *inner, (x[-1], messenger(x[-1]), 0, 0, 0)]


UNLIKE = table(
    supported(0, 48, 113, 154, 215, messenger=lambda x: 1.3 + 0.001 * x + 0.05 * (x == 113)),
    [
        (x, 0, 0.001 * x - 0.0005 * min(x - a, b - x))
        for a, b, n in ((0, 48, 5), (48, 113, 8), (113, 154, 3), (154, 215, 7))
        for x in np.linspace(a + 3.7, b - 4.1, n)
    ],
    masses=[(60.0, 0, 6.5), (113, 0, 2.0), (131.3, 1, 9.0), (172.0, 0, 3.0)],
    ends=(0.0, 0.215),
)
STITCHED = table(
    supported(0, 55, 120, 180, 235, messenger=lambda x: 1.6),
    [
        (x, float(any(abs(x - s) < 9 for s in (55, 120, 180))), 0.0)
        for s, e in ((0, 55), (55, 120), (120, 180), (180, 235))
        for x in (s + 2.6, *np.linspace(s + 11, e - 11, 5), e - 2.6)
    ],
    stitches=[(s - 9.0, s + 9.0, 2800.0, 0.31, 0.4) for s in (55, 120, 180)],
)
_WRONG = np.random.default_rng(3).normal(0, 0.004, 24)
IRREGULAR = replace(
    UNLIKE,
    droppers=np.array(
        [
            (*row.tolist()[:8], 0, wrong + (10.0 if i == 9 else 0))
            for i, (row, wrong) in enumerate(zip(UNLIKE.droppers, _WRONG))
        ],
        line_table.DROPPER,
    ),
    profile=np.array(
        [(x, 0.002 * np.sin(8 * x), 0.016 * np.cos(8 * x)) for x in np.arange(20, 200, 0.17)], line_table.PROFILE
    ),
)
LINES = {"unlike spans": UNLIKE, "stitched": STITCHED, "irregular": IRREGULAR}
