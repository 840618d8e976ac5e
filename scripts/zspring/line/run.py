"""A run of pantographs along a line: both FMUs from start to stop, and the record of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace

from ..errors import ZSpringError
from ..fmu import Instance
from ..interrupt import Interrupted, stop_on_interrupt
from ..variables import Value, exact_list, parse, with_unit
from .calls import PreparedCalls
from .journey import FittedJourney
from .limits import most_supports
from .recorder import Recorder
from .result import LineResult
from .schemes import MAPPED, GaussSeidel, Implicit, Jacobi, Mapped, Pantographs
from .sides import ContactInMaster, ContactInPantograph, Wire
from .stated import BOUNDARIES, UNDISTURBED
from .system import System
from .waves import fastest, undisturbed_until

LOOK_EVERY = 50  # steps between two looks at Ctrl-C and the progress bar


def run_line(system: System, progress: bool = False) -> LineResult:
    """Run the pantographs along the line.

    progress        show a progress bar
    Raises ZSpringError for settings that do not fit the line, FmuError when an FMU refuses something, and
    Interrupted after Ctrl-C.
    """
    with LineRun(system) as run:
        run.finish(progress)
        return run.result()


class LineRun:
    """A run that can end early: `result` has the rows so far. A context manager that frees the FMUs.

    Errors as those of run_line.
    """

    def __init__(self, system: System):
        self.line = system.extent
        self.journey = journey = self.line.complete(system.journey, len(system.pantographs))
        self._run_up = self.line.run_up(journey.start)
        self.system = replace(system, journey=journey)
        self.steps = math.floor((journey.stop - journey.start) / (journey.speed * journey.step) + 1e-9)
        self._static_forces = system.of_each("static_force")
        self._done, self._elapsed = 0, 0.0
        self._stack = ExitStack()
        try:
            self._start()
        except BaseException:
            self._stack.close()
            raise

    def _start(self) -> None:
        """Both FMUs initialised, and the master's parts around them."""
        system, count = self.system, len(self.system.pantographs)
        (wire,) = self._stack.enter_context(system.catenary.instances())
        heads = self._stack.enter_context(system.pantograph.instances(count))
        for head, (parameters, inputs) in zip(heads, self.head_starts):
            head.start(parameters, inputs)
        wire.start(*self.wire_start)
        datum = wire.get([f"pantograph[{i + 1}].wire_height" for i in range(count)])
        self.lifted = datum  # m, at the start by static_force
        if self.exchange:
            parameters, inputs = self.wire_start
            wire.start({**parameters, **self.exchange}, inputs)
        else:
            datum = [0.0] * count
        self.settings = _settings(system, self.journey, wire, heads)

        wire_calls, *head_calls = (self._stack.enter_context(PreparedCalls(i)) for i in (wire, *heads))
        self._wire = Wire(wire_calls, datum)
        self._uplifts = [calls.reals([f"uplift.{self.journey.uplift_on}"]) for calls in head_calls]
        self._scheme = self._make_scheme(head_calls)
        supports = self.line.supports[: most_supports(system.catenary)]
        self._record = Recorder(self.steps + 1, wire_calls, head_calls, supports, datum, system.watched)
        self._record.take(0, self._shifts(0.0))

    @property
    def head_starts(self) -> list[tuple[dict[str, Value], dict[str, float]]]:
        """Parameters and first inputs of each pantograph."""
        direct, acts_on = self.journey.start_up == "direct", f"uplift.{self.journey.uplift_on}"
        drive = parse(self.system.pantograph.variables["drive"], self.system.coupling.drive)
        return [
            ({**parameters, "drive": drive}, {"contact_force": force, acts_on: uplift if direct else 0.0})
            for parameters, force, uplift in zip(self.system.pantographs, self._static_forces, self.journey.uplift)
        ]

    @property
    def wire_start(self) -> tuple[dict[str, Value], dict[str, float]]:
        """Parameters and first inputs of the catenary."""
        unread = {"solver.energies"} & set(self.system.catenary.variables.names("parameter"))  # older FMUs lack it
        parameters, inputs = {**dict.fromkeys(unread, False), **self.system.line}, dict[str, float]()
        for i, force in enumerate(self._static_forces):
            name = f"pantograph[{i + 1}]"
            parameters[f"{name}.start"] = self.journey.start - i * self.journey.spacing
            inputs |= {f"{name}.force": force, f"{name}.speed": self.journey.speed}
        return parameters, inputs

    @property
    def exchange(self) -> dict[str, Value]:
        """Parameters with which the catenary tells its affine map; its heights then count from the lifted wire."""
        scheme = self.system.coupling.scheme
        if scheme not in MAPPED:
            return {}
        forces = {f"pantograph[{i + 1}].static_force": force for i, force in enumerate(self._static_forces)}
        exchange = parse(self.system.catenary.variables["exchange"], MAPPED[scheme])
        return {**forces, "exchange": exchange, "exchange.step": self.journey.step}

    def _make_scheme(self, head_calls: Sequence[PreparedCalls]) -> Mapped | Implicit | GaussSeidel | Jacobi:
        coupling, forces = self.system.coupling, self._static_forces
        if coupling.scheme in MAPPED:
            mapped = [ContactInPantograph(calls) for calls in head_calls]
            return Mapped(self._wire, mapped, coupling.scheme == "parallel")
        if coupling.drive == "Wire":
            sides: Pantographs = [ContactInPantograph(calls) for calls in head_calls]
        else:
            for damping in filter(None, self.system.of_each("contact.c")):
                raise ZSpringError(f"contact.c = {damping:g} N.s/m: must be 0 with drive Force; use drive Wire")
            stiffness = self.system.of_each("contact.k")
            sides = [ContactInMaster(*each) for each in zip(head_calls, forces, stiffness)]
        if coupling.scheme == "implicit":
            tolerance = coupling.tolerance * max(1.0, *forces)
            return Implicit(self._wire, sides, tolerance, coupling.max_iterations)
        return GaussSeidel(self._wire, sides) if coupling.scheme == "explicit" else Jacobi(self._wire, sides)

    def finish(self, progress: bool = False) -> None:
        """Run to the stop. Raises Interrupted after Ctrl-C."""
        size, begin = self.journey.step, time.process_time()
        with stop_on_interrupt() as stop, _bar(self.steps, progress) as tell:
            try:
                for i in range(self._done, self.steps):
                    end = (i + 1) * size
                    shifts = self._shifts(end)
                    self._scheme.advance(i * size, size, shifts)
                    self._record.take(i + 1, shifts)
                    self._done = i + 1
                    if i % LOOK_EVERY == 0:
                        tell(i + 1)
                        if stop.is_set():
                            raise Interrupted(f"interrupted at {end:g} s")
                tell(self.steps)
            finally:
                self._elapsed += time.process_time() - begin

    @property
    def wire_steps(self) -> float:
        """Steps of the catenary for one communication step, so far."""
        return self._wire.steps / max(1, self._done)

    def result(self) -> LineResult:
        """All rows so far."""
        rows = slice(self._done + 1)
        return self._record.result(rows, self.journey.step, self.settings, self._elapsed)

    def _shifts(self, now: float) -> list[float]:
        """How much lower than the catenary says the pantographs meet the wire, m; sets the ramp's uplift."""
        if self.journey.start_up == "direct":
            return self.lifted
        travelled = now * self.journey.speed / self._run_up
        if travelled >= 1.0 + self.journey.step * self.journey.speed / self._run_up:
            return [0.0] * len(self.lifted)
        rest = 0.5 * (1.0 + math.cos(math.pi * min(travelled, 1.0)))
        for input_of, uplift in zip(self._uplifts, self.journey.uplift):
            input_of.set((uplift * (1.0 - rest),))
        return [rest * height for height in self.lifted]

    def __enter__(self) -> LineRun:
        return self

    def __exit__(self, *_) -> None:
        self._stack.close()


@contextmanager
def _bar(steps: int, is_shown: bool) -> Iterator[Callable[[int], object]]:
    """A progress bar, as a function of the steps done."""
    if not is_shown:
        yield lambda done: None
        return
    from tqdm import tqdm  # which workers of a study need not have

    with tqdm(total=steps, unit=" steps", disable=None) as bar:
        yield lambda done: bar.update(done - bar.n)


def _settings(system: System, journey: FittedJourney, wire: Instance, heads: Sequence[Instance]) -> dict[str, str]:
    """Everything that it takes to repeat the run, in words."""
    coupling = system.coupling
    settings = {
        "speed": f"{journey.speed * 3.6:.6g} km/h",
        "start": f"{journey.start:g} m",
        "stop": f"{journey.stop:g} m",
        "step": f"{journey.step:g} s",
        "start-up": journey.start_up,
        "uplift": f"{', '.join(f'{uplift:g}' for uplift in dict.fromkeys(journey.uplift))} N on {journey.uplift_on}",
        "coupling": coupling.scheme,
        "drive": coupling.drive,
        "pantographs": str(len(heads)),
    }
    if len(heads) > 1:
        settings["spacing"] = f"{journey.spacing:g} m"
    if coupling.scheme == "implicit":
        settings["tolerance"] = f"{coupling.tolerance:g}"
    for i in range(len(heads)):
        until = undisturbed_until(system.extent, journey, i * journey.spacing, fastest(system.catenary, system.line))
        settings[UNDISTURBED.format(i + 1)] = f"{until:.1f} m"
    if system.catenary.line:
        settings[BOUNDARIES] = exact_list(system.extent.boundaries, "m")
    named = [("catenary", system.catenary, wire)]
    named += [(f"pantograph {i + 1}", system.pantograph, head) for i, head in enumerate(heads)]
    for prefix, fmu, instance in named:
        settings |= {f"{prefix} {key}": value for key, value in fmu.identity.items()}
        for name, value in instance.used_parameters().items():
            settings[f"{prefix} {name}"] = with_unit(fmu.variables[name], value)
    return settings
