"""Any order of FMI calls, right and wrong ones: the rules of helpers/rules_machine.py by hypothesis."""

from __future__ import annotations

from rules_machine import run_rules


def test_any_order_of_calls_follows_the_rules(model, any_fmu):
    run_rules(model, any_fmu, 30, 30, derandomize=True)
