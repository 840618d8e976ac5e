"""An experiment whose stop time is infinity has none: its states are as good as any."""

from __future__ import annotations

import math

from models import each_case


@each_case
def test_a_state_of_an_endless_experiment_is_restored(model, instance, case):
    p = instance(case.parameters, stop_time=math.inf)
    p.run(0.01, 3, [], signals=case.inputs)
    state = p.slave.getFMUstate()
    saved = p.slave.serializeFMUstate(state)
    p.slave.freeFMUstate(state)
    p.run(0.01, 3, [], signals=case.inputs)
    expected = p.all_values()

    state = p.slave.deSerializeFMUstate(saved)
    p.slave.setFMUstate(state)
    p.slave.freeFMUstate(state)
    p.time = 0.03
    p.run(0.01, 3, [], signals=case.inputs)
    assert p.all_values() == expected
