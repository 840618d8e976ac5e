"""Any order of calls through Python, on two instances of each FMU at once, against a small model of the rules.

What FMI 2.0 says in its table of states (4.2.4), of values (2.2.7), of discarded steps (4.2.2) and of FMU states
(2.1.8). tests/native/fuzz does the same in C++ with broken arguments as well; here each rule can be read.
"""

from __future__ import annotations

import math

from fmpy.fmi2 import fmi2Discard, fmi2Error, fmi2LastSuccessfulTime, fmi2OK
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule, run_state_machine_as_test

from harness import Fmu, Instance, refusal
from models import Model

INSTANTIATED, INITIALIZATION, STEPPING, TERMINATED = "instantiated", "initialization", "stepping", "terminated"
BEFORE_START = (INSTANTIATED, INITIALIZATION)

instances = st.integers(0, 1)
positions = st.integers(0, 10_000)
steps = st.sampled_from([1e-5, 1e-3, 2e-3, 0.01])
wrong_steps = st.sampled_from([0.0, -1e-3, math.nan, math.inf])
values = st.one_of(st.floats(-2, 2), st.sampled_from([math.nan, math.inf, -1e300, 1e300, 1e12, 1.0, 2.0, 120.0]))


class Subject:
    """An instance and what it should be."""

    def __init__(self, fmu: Fmu, model: Model):
        self.instance = Instance(fmu, initialize=False)
        self.model = model
        self.forget()

    def forget(self) -> None:
        """As after instantiation and reset."""
        self.state, self.time = INSTANTIATED, 0.0
        fmu = self.instance.fmu
        causes = ("parameter", "input")
        self.values = {n: fmu.start(n) for n, v in fmu.variables.items() if v.causality in causes}
        for name, value in self.model.smallest.items():
            self.instance[name] = value
            self.values[name] = value

    def may_set(self, name: str, value: float) -> bool:
        v = self.instance.fmu.variables[name]
        if self.state == TERMINATED or name not in self.values:
            return False
        if v.causality == "parameter" and v.variability == "fixed" and self.state not in BEFORE_START:
            return False
        low = -math.inf if v.min is None else float(v.min)
        high = math.inf if v.max is None else float(v.max)
        if v.declaredType:
            low, high = 1, len(v.declaredType.items)
        return math.isfinite(value) and low <= value <= high


class Rules(RuleBasedStateMachine):
    fmu: Fmu
    model: Model

    def __init__(self):
        super().__init__()
        self.subjects = [Subject(self.fmu, self.model) for _ in range(2)]
        self.kept: list[tuple[bytes, str, float, dict[str, float], dict[str, float] | None]] = []

    def teardown(self) -> None:
        for subject in self.subjects:
            subject.instance.close()

    def call(self, which: int, allowed: bool, function, *arguments) -> int:
        """The status, which must be OK exactly if allowed; a refusal comes with one line and changes no value."""
        subject = self.subjects[which]
        before = self.readable(subject)
        status = refusal(function, *arguments)
        assert status == (fmi2OK if allowed else fmi2Error)
        if status != fmi2OK:
            assert self.readable(subject) == before
        return status

    @staticmethod
    def readable(subject: Subject) -> dict[str, float] | None:
        return subject.instance.all_values() if subject.state in (STEPPING, TERMINATED) else None

    @initialize()
    def begin(self) -> None:
        self.start(0)

    @rule(which=instances)
    def start(self, which: int) -> None:
        subject = self.subjects[which]
        subject.instance.slave.reset()
        subject.forget()
        subject.instance.initialize()
        subject.state = STEPPING

    @rule(which=instances)
    def reset(self, which: int) -> None:
        self.subjects[which].instance.slave.reset()
        self.subjects[which].forget()

    @rule(which=instances, start=st.sampled_from([0.0, 3.5, -2.0, math.nan]))
    def setup_experiment(self, which: int, start: float) -> None:
        s = self.subjects[which]
        allowed = s.state == INSTANTIATED and math.isfinite(start)
        if self.call(which, allowed, lambda: s.instance.slave.setupExperiment(startTime=start)) == fmi2OK:
            s.time = start

    @rule(which=instances)
    def enter_initialization(self, which: int) -> None:
        s = self.subjects[which]
        if self.call(which, s.state == INSTANTIATED, s.instance.slave.enterInitializationMode) == fmi2OK:
            s.state = INITIALIZATION

    @rule(which=instances)
    def exit_initialization(self, which: int) -> None:
        s = self.subjects[which]
        if s.state == INITIALIZATION:  # parameters that make no model are refused here
            if refusal(s.instance.slave.exitInitializationMode) == fmi2OK:
                s.state = STEPPING
        else:
            self.call(which, False, s.instance.slave.exitInitializationMode)

    @rule(which=instances)
    def terminate(self, which: int) -> None:
        s = self.subjects[which]
        if self.call(which, s.state == STEPPING, s.instance.slave.terminate) == fmi2OK:
            s.state = TERMINATED

    @rule(which=instances, position=positions, value=values)
    def set(self, which: int, position: int, value: float) -> None:
        s = self.subjects[which]
        names = list(self.fmu.variables)
        name = names[position % len(names)]
        v = self.fmu.variables[name]
        if v.type == "Real":
            if name.startswith(("solver", "mesh", "line")) and math.isfinite(value) and value != s.values.get(name):
                return  # what a step costs
            call = s.instance.slave.setReal
        else:
            value = int(value) if math.isfinite(value) and abs(value) < 1e9 and name not in self.model.smallest else -1
            call = s.instance.slave.setBoolean if v.type == "Boolean" else s.instance.slave.setInteger
        if self.call(which, s.may_set(name, value), call, [v.valueReference], [value]) == fmi2OK:
            s.values[name] = value

    @rule(which=instances, position=positions, change=st.floats(-0.01, 0.01))
    def move_an_input(self, which: int, position: int, change: float) -> None:
        s = self.subjects[which]
        names = [name for name in self.fmu.names("input") if not name.startswith("wire.")]  # only in one drive
        name = names[position % len(names)]
        reference = [self.fmu.variables[name].valueReference]
        value = float(self.fmu.start(name)) + change
        if self.call(which, s.state != TERMINATED, s.instance.slave.setReal, reference, [value]) == fmi2OK:
            s.values[name] = value

    @rule(which=instances, h=steps)
    def step(self, which: int, h: float) -> None:
        s = self.subjects[which]
        if s.state != STEPPING:
            self.call(which, False, s.instance.slave.doStep, s.time, h)
            return
        before = s.instance.all_values()
        status = refusal(s.instance.slave.doStep, s.time, h)
        assert status in (fmi2OK, fmi2Discard)
        if status == fmi2OK:
            s.time += h
        else:
            assert s.instance.all_values() == before
        assert s.instance.slave.getRealStatus(fmi2LastSuccessfulTime) == s.time

    @rule(which=instances, h=wrong_steps)
    def step_of_no_length(self, which: int, h: float) -> None:
        self.call(which, False, self.subjects[which].instance.slave.doStep, self.subjects[which].time, h)

    @rule(which=instances, off=st.sampled_from([-1.0, 0.01, math.nan]))
    def step_from_another_time(self, which: int, off: float) -> None:
        self.call(which, False, self.subjects[which].instance.slave.doStep, self.subjects[which].time + off, 1e-3)

    @rule(which=instances)
    def keep_state(self, which: int) -> None:
        s = self.subjects[which]
        state = s.instance.slave.getFMUstate()
        data = s.instance.slave.serializeFMUstate(state)
        s.instance.slave.freeFMUstate(state)
        self.kept = [*self.kept[-4:], (data, s.state, s.time, dict(s.values), self.readable(s))]

    @rule(which=instances, position=positions)
    def restore_state(self, which: int, position: int) -> None:
        """Also one that the other instance made."""
        if not self.kept:
            return
        s = self.subjects[which]
        data, s.state, s.time, own, readable = self.kept[position % len(self.kept)]
        state = s.instance.slave.deSerializeFMUstate(data)
        s.instance.slave.setFMUstate(state)
        s.instance.slave.freeFMUstate(state)
        s.values = dict(own)
        assert self.readable(s) == readable

    @rule(which=instances, position=positions, bit=st.integers(0, 7))
    def restore_a_damaged_state(self, which: int, position: int, bit: int) -> None:
        if not self.kept:
            return
        data = bytearray(self.kept[-1][0])
        data[position % len(data)] ^= 1 << bit
        self.call(which, False, self.subjects[which].instance.slave.deSerializeFMUstate, bytes(data))

    @invariant()
    def values_are_what_was_set_and_outputs_are_finite(self) -> None:
        for s in self.subjects:
            read = self.readable(s)
            if read is not None:
                assert all(math.isfinite(value) for value in read.values())
                assert {name: read[name] for name in s.values} == s.values


def run_rules(model: Model, fmu: Fmu, examples: int, steps_each: int, *, derandomize: bool) -> None:
    machine = type("RulesOf" + model.name, (Rules,), {"fmu": fmu, "model": model})
    run_state_machine_as_test(
        machine,
        settings=settings(
            max_examples=examples, stateful_step_count=steps_each, derandomize=derandomize, deadline=None, database=None
        ),
    )
