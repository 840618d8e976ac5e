"""The master's algorithms on wires and pantographs of a line of algebra each, where every answer is known."""

from __future__ import annotations

import re

import numpy as np
import pytest

from zspring.errors import ZSpringError
from zspring.line.schemes import GaussSeidel, Implicit, Jacobi

SIZE = 0.5


class Springs:
    """A wire whose heights answer at once: heights = rest + a function of the forces. Counts its steps."""

    def __init__(self, answer, slopes, rest=(0.0, 0.0), velocities=(0.0, 0.0)):
        self._answer, self._slopes = answer, slopes
        self._rest, self.heights, self.velocities = np.array(rest), np.array(rest), np.array(velocities)
        self.steps = self.restored = self.saved = 0
        self.forces = None

    def save(self) -> None:
        self.saved += 1

    def restore(self) -> None:
        self.restored += 1

    def step(self, time: float, size: float, forces) -> None:
        self.steps += 1
        self.time, self.forces = (time, size), np.array(forces)
        self.heights = self._rest + self._answer(self.forces)

    def compliance(self):
        return self._slopes(self.forces).T


class Contact:
    """A pantograph with its head held at `place`: force = k (place - height), and never below 0."""

    def __init__(self, stiffness: float, place: float, by_force: float = 0.0):
        self._stiffness, self._place, self._by_force = stiffness, place, by_force
        self.force, self.heights = 1.0, []

    def save(self) -> None: ...

    def restore(self) -> None: ...

    def step(self, time: float, size: float, height: float, force: float) -> float:
        self.heights.append(height)
        raw = self._stiffness * (self._place - height) + self._by_force * force
        self._closed = raw > 0
        return max(0.0, raw)

    explicit_step = step

    def slopes(self) -> tuple[float, float]:
        return (-self._stiffness, self._by_force) if self._closed else (0.0, 0.0)


MATRIX = np.array([[0.02, 0.004], [0.01, 0.03]])  # heights by forces, m/N


def linear(rest=(0.0, 0.0), velocities=(0.0, 0.0)) -> Springs:
    return Springs(lambda f: MATRIX[: len(f), : len(f)] @ f, lambda f: MATRIX[: len(f), : len(f)], rest, velocities)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("by_force", [0.0, -0.4])
def test_implicit_coupling_solves_a_linear_system_in_two_steps_of_the_wire(count, by_force):
    """f_i = k_i (place_i - h_i + shift_i) + b f_i with h = rest + C f."""
    k, place = np.array([400.0, 150.0])[:count], np.array([0.5, 0.8])[:count]
    rest, shifts = np.array([0.1, -0.05])[:count], np.array([0.02, -0.03])[:count]
    wire = linear(rest)
    contacts = [Contact(*each, by_force) for each in zip(k, place)]
    scheme = Implicit(wire, contacts, 1e-9, 30)
    scheme.advance(3.0, SIZE, shifts)
    C = MATRIX[:count, :count]
    expected = np.linalg.solve((1 - by_force) * np.eye(count) + k[:, None] * C, k * (place - rest + shifts))
    np.testing.assert_allclose(scheme.forces, expected, rtol=1e-9)
    assert [contact.force for contact in contacts] == list(scheme.forces)
    assert (wire.steps, wire.restored, wire.saved, wire.time) == (2, 1, 1, (3.0, SIZE))
    np.testing.assert_allclose(wire.forces, expected, rtol=1e-9)
    # Begun from 2 f - f_before: where nothing changes the first step is the last.
    scheme.advance(3.5, SIZE, shifts)
    scheme.advance(4.0, SIZE, shifts)
    assert wire.steps == 2 + 2 + 1


def test_a_lost_contact_has_no_force():
    """The first head is below its wire whatever happens; the second one stands alone."""
    wire, contacts = linear(), [Contact(400.0, -0.5), Contact(150.0, 0.8)]
    scheme = Implicit(wire, contacts, 1e-9, 30)
    scheme.advance(0.0, SIZE, (0.0, 0.0))
    np.testing.assert_allclose(scheme.forces, [0.0, 150 * 0.8 / (1 + 150 * 0.03)], atol=1e-9)


def kinked(ratio: float, d: float = 5.0, root: float = 60.0) -> Springs:
    """A wire that is `ratio` times as soft within d of the force `root`, where its height is 0."""

    def answer(f):
        x = f - root
        return 1e-3 * (x + (ratio - 1) * np.clip(x, -d, d))

    def slopes(f):
        return 1e-3 * np.where(np.abs(f - root) < d, ratio, 1.0).reshape(1, 1)

    return Springs(answer, slopes, rest=(0.0,), velocities=(0.0,))


@pytest.mark.parametrize("ratio, most", [(1.5, 6), (3.0, 26)])
def test_corrections_are_halved_where_full_ones_would_alternate(ratio, most):
    """The contact is so stiff that the wire's slope is all that counts. Newton's full steps then go to and fro at
    d (ratio - 1) beside the root if the ratio is above 2; halved ones come in, by half of the rest each."""
    wire = kinked(ratio)
    scheme = Implicit(wire, [Contact(1e5, 60 / 1e5)], 1e-2, 30)
    scheme.forces = scheme._before = [90.0]
    scheme.advance(0.0, SIZE, (0.0,))
    assert scheme.forces[0] == pytest.approx(60.0, abs=1e-3)
    assert 2 <= wire.steps <= most
    if ratio > 2:
        assert wire.steps > 7  # so the full corrections were tried before


def test_what_does_not_converge_is_told_with_how_far_it_is_off():
    """By the contact's answer to the last heights, less the force that made these; nothing of it is passed on."""
    wire = kinked(3.0)
    scheme = Implicit(wire, [Contact(1e5, 60 / 1e5)], 1e-6, 5)
    scheme.forces = scheme._before = [90.0]
    told = r"does not converge at 2\.5 s: after 5 iterations it is (\S+) N off, allowed are 1e-06 N"
    with pytest.raises(ZSpringError, match=told) as error:
        scheme.advance(2.0, SIZE, (0.0,))
    assert wire.steps == 5 and scheme.forces == [90.0]
    answer = 1e5 * (60 / 1e5 - wire.heights[0])
    off = float(re.search(told, str(error.value))[1])
    assert off == pytest.approx(abs(max(0.0, answer) - wire.forces[0]), rel=0.05) and off > 1


def test_explicit_coupling_extrapolates_the_wire_and_then_moves_it():
    """Each head meets the wire where its velocity takes it; the wire gets the forces that answer to this."""
    wire = linear((0.1, -0.05), velocities=(0.04, -0.2))
    contacts = [Contact(400.0, 0.5), Contact(150.0, 0.8)]
    scheme = GaussSeidel(wire, contacts)
    scheme.advance(1.0, SIZE, (0.02, -0.03))
    heights = [0.1 + SIZE * 0.04 - 0.02, -0.05 - SIZE * 0.2 + 0.03]
    expected = [400 * (0.5 - heights[0]), 150 * (0.8 - heights[1])]
    assert [contact.heights for contact in contacts] == [[pytest.approx(h)] for h in heights]
    np.testing.assert_allclose(scheme.forces, expected)
    np.testing.assert_allclose(wire.forces, expected)
    assert wire.steps == 1 and [contact.force for contact in contacts] == scheme.forces


def test_side_by_side_each_side_has_the_others_last_value():
    wire = linear((0.1, -0.05), velocities=(9.0, 9.0))
    contacts = [Contact(400.0, 0.5), Contact(150.0, 0.8)]
    scheme = Jacobi(wire, contacts)
    scheme.advance(1.0, SIZE, (0.02, -0.03))
    np.testing.assert_allclose(wire.forces, [1.0, 1.0])  # as the contacts had them before
    first = [400 * (0.5 - 0.1 + 0.02), 150 * (0.8 + 0.05 - 0.03)]
    np.testing.assert_allclose(scheme.forces, first)
    scheme.advance(1.5, SIZE, (0.0, 0.0))
    np.testing.assert_allclose(wire.forces, first)
    heights = np.array([0.1, -0.05]) + MATRIX @ [1.0, 1.0]
    np.testing.assert_allclose(scheme.forces, [400 * (0.5 - heights[0]), 150 * (0.8 - heights[1])])
