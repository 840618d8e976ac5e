"""The same inputs, the same bits: in other runs and processes, and with any number of workers.

After reset, after restoring a state and in threads: test_fmi_replay.py.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

from paths import TESTS
from zspring.fmu import CATENARY, PANTOGRAPH

RUN = """
import hashlib
import sys
import numpy as np
sys.path.insert(0, sys.argv[1])
from random_sets import MODELS, drive, random_set
from zspring.fmu import Fmu, FmuError, installed_fmu
digest = hashlib.sha256()
model = sys.argv[2]
with Fmu(installed_fmu(model)) as fmu, fmu.instances() as (instance,):
    for seed in range(20):
        values = random_set(fmu, np.random.default_rng(seed), 0.3)
        try:
            digest.update(drive(instance, MODELS[model], values, seed, 0.01).outputs.tobytes())
        except FmuError as refusal:
            digest.update(str(refusal).encode())
print(digest.hexdigest())
"""


@pytest.mark.parametrize("model", [PANTOGRAPH, CATENARY])
def test_every_process_computes_the_same_bits(model):
    command = [sys.executable, "-c", RUN, str(TESTS / "helpers"), model]
    digests = {subprocess.run(command, check=True, capture_output=True, text=True).stdout for _ in range(2)}
    assert len(digests) == 1
    assert len(digests.pop().strip()) == 64
