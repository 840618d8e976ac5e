"""The linear models that `zspring linearize` writes: published anchors, the FMU's vibration, its bench."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.io import loadmat

from commands import zspring
from harness import PRECISE, bench_point
from linear import PUBLISHED, LinearPantograph, ZSpringLinear, step_error
from zspring.fmu import Fmu
from zspring.linearize.modes import complex_modes, natural_frequencies
from zspring.receptance import MODELS, LinearModel, linear_model

SUSPENSIONS = {"linear": "Linear", "locked": "LinearLocked", "free": "LinearFree"}
UNEQUAL = {"zspring.J1": 5e-4, "zspring.J2": 9e-4}  # else one rod mode, both rods against each other, never moves


def model_of(parameters, name):
    with Fmu() as fmu:
        used = fmu.used_parameters(parameters)
        reach = np.array([0.075 if dof in ("alpha", "beta") else 1.0 for dof in linear_model(used, name).names])
        return linear_model(used, name), reach


@pytest.mark.parametrize(
    "k1, natural, held",
    [(9430.0, [0.012, 6.558, 12.307], [4.128, 11.995]), (4715.0, [0.012, 4.942, 11.548], [3.051, 11.476])],
)
def test_the_published_dsa_380_table_has_these_frequencies(tmp_path, k1, natural, held):
    """Masses, springs and damper of Wang et al., extended Habedank model of pantograph arcing, table II.

    The frequencies follow from that table; those of half the head spring are of the static stiffness, which
    the published non-linear model has at about half of the dynamic one.
    """
    out, _ = zspring(tmp_path, "linearize", "--set", f"k1={k1}", "--output", "out")
    with np.load(tmp_path / "out/linear-linear.npz") as file:
        np.testing.assert_allclose(file["natural_frequencies"], natural, atol=5e-4)
        np.testing.assert_allclose(file["head_held_frequencies"], held, atol=5e-4)
    assert f"{natural[1]:.3f}, {natural[2]:.3f} Hz" in out and f"{held[0]:.3f}, {held[1]:.3f} Hz" in out


def test_a_named_parameter_set_is_linearised(tmp_path):
    zspring(tmp_path, "linearize", "--parameters", "dsa-250", "--output", "out")
    published = dict(PUBLISHED["DSA-250"])
    expected = LinearPantograph(head=published.pop("k1"), **published).frequencies()
    with np.load(tmp_path / "out/linear-linear.npz") as file:
        np.testing.assert_allclose(file["natural_frequencies"], expected, rtol=1e-9)


def test_npz_and_mat_hold_the_same_model(tmp_path):
    """In a folder that is made with those above it."""
    zspring(tmp_path, "linearize", "--frequencies", "1:10:1", "--output", "new/out")
    for name in MODELS:
        matlab = loadmat(tmp_path / f"new/out/linear-{name}.mat")
        with np.load(tmp_path / f"new/out/linear-{name}.npz") as file:
            n = len(file["dof"])
            assert [str(cell[0]) for cell in matlab["dof"].ravel()] == list(file["dof"])
            assert [str(cell[0]) for cell in matlab["unit"].ravel()] == list(file["unit"])
            for key in ("M", "C", "K", "eigenvalues", "eigenvectors", "frequency", "receptance"):
                np.testing.assert_array_equal(matlab[key].ravel(), file[key].ravel(), err_msg=key)
            M, C, K, s, shapes = (file[key] for key in ("M", "C", "K", "eigenvalues", "eigenvectors"))
            assert M.shape == C.shape == K.shape == (n, n) and shapes.shape == (n, len(s))
            residual = s**2 * (M @ shapes) + s * (C @ shapes) + K @ shapes
            assert np.abs(residual).max() < 1e-8 * np.abs(K @ shapes).max()
            assert file["receptance"].shape == file["frequency"].shape == (10,)


@pytest.mark.parametrize("name", MODELS)
def test_the_matrices_are_those_of_an_independent_derivation(pantograph, name):
    p = pantograph(UNEQUAL)
    head = {"linear": p["k1"], "locked": ZSpringLinear.of(p).k_locked, "free": ZSpringLinear.of(p)}[name]
    rods = {"rods": (p["zspring.J1"], p["zspring.J2"])} if name == "free" else {}
    model, _ = model_of(UNEQUAL, name)
    for own, other in zip((model.M, model.C, model.K), LinearPantograph.of(p, head, **rods).matrices()):
        np.testing.assert_allclose(own, other, rtol=1e-9, atol=1e-9 * np.abs(other).max())


@pytest.mark.parametrize("name", MODELS)
def test_the_fmu_vibrates_freely_in_these_modes(pantograph, name):
    """Samples of free vibration follow x(t + T) = A x(t) + B x(t - T) with eigenvalues exp(s T) of the modes.

    Dampers throughout, so that every mode has a damping to find. At HHT's alpha = 0 and a step h the
    trapezoidal rule moves s by (h s)^2 / 12, relatively.
    """
    dampers = {"c1": 30.0, "c2": 20.0}
    step = 1e-4
    outputs = ["head.z", "upper_frame.z", "lower_frame.z"]
    if name == "free":
        outputs[1:1] = ["zspring.alpha", "zspring.beta"]
    settings = dampers | UNEQUAL | {"suspension": SUSPENSIONS[name], "solver.alpha": 0.0, "solver.step": step}
    p = pantograph(PRECISE | settings)
    p["uplift.lower_frame"] = 200.0
    p["uplift.head"] = -100.0
    p.step(0.02)
    p["uplift.lower_frame"] = p["uplift.head"] = 0.0
    p.step(0.01)
    interval = 4e-3
    x = p.run(interval, 400, outputs)
    if name == "free":
        x[:, 1:3] -= p["zspring.theta"]
    n = len(outputs)
    a = np.linalg.lstsq(np.hstack([x[1:-1], x[:-2]]), x[2:], rcond=None)[0]
    found = np.log(np.linalg.eigvals(np.vstack([a.T, np.eye(n, 2 * n)])).astype(complex)) / interval
    modes = complex_modes(*model_of(dampers | UNEQUAL, name))
    vibrations = modes.eigenvalues[np.abs(modes.eigenvalues) > 10]
    assert len(vibrations) == n - 1
    for s in vibrations:
        assert np.abs(found - s).min() < abs(s) * (2 * (step * abs(s)) ** 2 / 12 + 2e-6)


@pytest.mark.parametrize("name", MODELS)
def test_the_receptance_is_what_the_fmu_measures_on_its_bench(pantograph, name):
    """With a damper at the head, without which the rods' own vibration would not settle."""
    parameters = {"c1": 1000.0}
    step = 2e-4
    model, _ = model_of(parameters, name)
    bench = {"drive": "Bench", "suspension": SUSPENSIONS[name], "solver.step": step}
    p = pantograph(PRECISE | parameters | bench)

    class Linear:
        receptance = staticmethod(lambda frequency: complex(model.receptance(np.array(frequency))))

    for frequency in (2.0, 4.9, 11.5):
        assert abs(bench_point(p, frequency, 0.25) - Linear.receptance(frequency)) < step_error(Linear, frequency, step)


def test_modes_come_by_ascending_magnitude_with_their_shapes_and_damping():
    """Three masses on their own springs; the second one is damped more than critically, at 4 and 16 1/s.

    The first is free and at rest; the last one oscillates with s = -1 +- 10i.
    """
    M, C, K = np.diag([5.0, 1.0, 2.0]), np.diag([0.0, 20.0, 4.0]), np.diag([0.0, 64.0, 202.0])
    modes = complex_modes(LinearModel(("u1", "u2", "u3"), M, C, K), np.array([1.0, 1.0, 0.5]))
    np.testing.assert_allclose(modes.eigenvalues, [0, 0, -4, -1 + 10j, -16], atol=1e-6)
    np.testing.assert_allclose(modes.damping[2:], [1, 1 / np.sqrt(101), 1], rtol=1e-9)
    np.testing.assert_allclose(modes.frequencies[2:], np.array([4, np.sqrt(101), 16]) / (2 * np.pi), rtol=1e-9)
    np.testing.assert_allclose(modes.shapes[:, 2:], [[0, 0, 0], [1, 0, 1], [0, 2, 0]], atol=1e-9)


def test_massless_rods_and_a_massless_lower_frame_leave_the_static_condensation():
    """The head's free stiffness is then k_free, and the frame one mass."""
    massless = {"zspring.J1": 0.0, "zspring.J2": 0.0, "m3": 0.0, "k3": 200.0}
    model, reach = model_of(massless, "free")
    with Fmu() as fmu:
        p = fmu.used_parameters(massless)
    head, base = p["zspring.k_free"], 1 / (1 / p["k2"] + 1 / p["k3"])
    chain = np.array([[head, -head], [-head, head + base]]) / np.sqrt(np.outer([p["m1"], p["m2"]], [p["m1"], p["m2"]]))
    expected = np.sqrt(np.linalg.eigvalsh(chain)) / (2 * np.pi)
    np.testing.assert_allclose(natural_frequencies(model), expected, rtol=1e-9)
    assert np.all(np.isfinite(complex_modes(model, reach).eigenvalues))
