"""Damaged manifests and tables through the commands: no traceback, no hang, no refusal without a word."""

from benchmarks.robustness.damaged_commands import try_commands


def test_commands_answer_or_refuse(tmp_path):
    found = try_commands(tmp_path, 15)
    assert found.faults == []
    outcomes = {outcome for _, outcome in found.counts}
    assert outcomes == {"accepted", "refused"}
