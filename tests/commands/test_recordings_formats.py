"""One record in every form of file: the same numbers, whoever wrote it."""

from __future__ import annotations

import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import pyuff
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from shaker import LINEAR, shaken, write_text
from zspring.errors import ZSpringError
from zspring.recordings.formats import read_recording
from zspring.recordings.run import holds_in
from zspring.recordings.settings import Settings
from zspring.recordings.signals import Record, read_record

RECORD = shaken((2.0, 3.3), rate=200.0)
SETTINGS = {
    "force": {"channel": "force", "sense": "contact", "unit": "N"},
    "displacement": {"channel": "position", "positive": "up", "unit": "mm"},
}
VALUES = {"force": RECORD.force, "position": 1e3 * RECORD.displacement}
UNITS = {"force": "N", "position": "mm"}


def read(path: Path, **settings) -> Record:
    content = {**SETTINGS, **settings, "recording": [{"file": path.name}]}
    checked = Settings.model_validate(content, context=path.parent)
    return read_record(checked.recording[0], checked)


def assert_same(record: Record) -> None:
    assert record.rate == pytest.approx(RECORD.rate, rel=1e-9)
    np.testing.assert_allclose(record.force.values, RECORD.force, rtol=1e-6)
    np.testing.assert_allclose(record.motions["displacement"].values, RECORD.displacement, rtol=1e-6, atol=1e-9)


def test_text_with_commas_in_its_numbers(tmp_path):
    path = write_text(
        tmp_path / "a.csv", {"Time (s)": RECORD.time, "Force (N)": VALUES["force"], "Position": VALUES["position"]}
    )
    path.write_text(path.read_text().replace(",", ";").replace(".", ","))
    assert_same(read(path))


def test_text_as_data_loggers_write_it(tmp_path):
    """Lines about the logger, names, their units below, two load cells; many more values than the drive needs."""
    record = shaken((2.0, 3.3), rate=5000.0)
    columns = {
        "Time": record.time,
        "cell A": 0.3 * record.force,
        "cell B": 0.7 * record.force,
        "LVDT": record.displacement,
    }
    path = write_text(tmp_path / "a.csv", columns)
    names, *rows = path.read_text().splitlines()
    path.write_text("\n".join(["Logger 7, bench 3", "channels: 4", names, "s,[N],[N],(m)", *rows]))
    force = {"channel": ["cell A", "cell B"], "sense": "contact"}
    content = {"force": force, "displacement": {"channel": "lvdt", "positive": "up"}}
    settings = Settings.model_validate({**content, "recording": [{"file": path.name, "skip": 2}]}, context=tmp_path)
    found = read_record(settings.recording[0], settings)
    assert found.rate == pytest.approx(5000)
    np.testing.assert_allclose(found.force.values, record.force, rtol=1e-9)
    points, _ = holds_in(found, settings)
    np.testing.assert_allclose([p.H for p in points], [LINEAR.receptance(f) for f in (2.0, 3.3)], rtol=1e-6)


def test_mat_files_of_both_kinds(tmp_path):
    """Vectors and a rate; the columns of a matrix; a struct; and version 7.3, whose arrays lie on their side."""
    savemat(tmp_path / "a.mat", {**VALUES, "Fs": 200.0, "note": "bench 3"})
    assert_same(read(tmp_path / "a.mat", time={"rate": 200.0}))
    savemat(tmp_path / "b.mat", {"data": np.column_stack([RECORD.time, *VALUES.values()])})
    named = {
        "time": {"channel": "data:1", "unit": "s"},
        "force": {**SETTINGS["force"], "channel": "data:2"},
        "displacement": {**SETTINGS["displacement"], "channel": "data:3"},
    }
    assert_same(read(tmp_path / "b.mat", **named))
    savemat(tmp_path / "c.mat", {"rec": VALUES})
    named["force"]["channel"], named["displacement"]["channel"] = "rec.force", "rec.position"
    assert_same(read(tmp_path / "c.mat", **{**named, "time": {"rate": 200.0}}))
    with h5py.File(tmp_path / "d.mat", "w", userblock_size=512) as file:
        for name, values in VALUES.items():
            file[name] = values[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    assert_same(read(tmp_path / "d.mat", time={"rate": 200.0}))


def test_hdf5_with_units(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, values in VALUES.items():
            file[f"run 1/{name}"] = values
            file[f"run 1/{name}"].attrs["unit"] = UNITS[name]
        table = np.zeros(RECORD.time.size, [("force", "f8"), ("position", "f8")])
        table["force"], table["position"] = VALUES.values()
        file["table"] = table
    fields = {name: {**SETTINGS[name], "channel": f"table/{SETTINGS[name]['channel']}"} for name in SETTINGS}
    assert_same(read(tmp_path / "a.h5", time={"rate": 200.0}, **fields))
    named = {name: {**SETTINGS[name], "channel": f"run 1/{SETTINGS[name]['channel']}"} for name in SETTINGS}
    for sensor in named.values():
        del sensor["unit"]
    assert_same(read(tmp_path / "a.h5", time={"rate": 200.0}, **named))


def test_tdms_tells_its_step_and_units(tmp_path):
    with TdmsWriter(tmp_path / "a.tdms") as file:
        for name, values in VALUES.items():
            told = {"unit_string": UNITS[name], "wf_increment": 1 / 200.0, "wf_start_offset": 0.0}
            file.write_segment([ChannelObject("run", name, values, properties=told)])
    assert_same(read(tmp_path / "a.tdms"))
    with TdmsWriter(tmp_path / "b.tdms") as file:
        for (name, values), step in zip(VALUES.items(), (1 / 200.0, 1 / 400.0)):
            file.write_segment([ChannelObject("run", name, values, properties={"wf_increment": step})])
    with pytest.raises(ZSpringError, match=r"b.tdms: sampling rates differ \(force 200 Hz, displacement 400 Hz\)"):
        read(tmp_path / "b.tdms")


def test_universal_files_of_time_records(tmp_path):
    sets = []
    for name, values in VALUES.items():
        told = {"func_type": 1, "id1": name, "ordinate_axis_units_lab": UNITS[name], "ord_data_type": 4, "binary": 0}
        told |= {"rsp_node": 1, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3, "abscissa_spec_data_type": 17}
        told |= {"ordinate_spec_data_type": 1, "orddenom_spec_data_type": 0, "z_axis_spec_data_type": 0}
        told |= {"abscissa_spacing": 1, "abscissa_inc": 1 / 200.0, "abscissa_min": 0.0}
        sets.append({**pyuff.prepare_58(x=RECORD.time, data=values, **told), "type": 58})
    pyuff.UFF(str(tmp_path / "a.uff")).write_sets(sets, mode="overwrite")
    record = read(tmp_path / "a.uff")
    np.testing.assert_allclose(record.force.values, RECORD.force, rtol=1e-4)
    assert record.rate == pytest.approx(200.0, rel=1e-5)


@pytest.mark.parametrize(
    "name, message",
    [("a.mat", "no MAT file"), ("a.h5", "no HDF5"), ("a.tdms", "no TDMS file"), ("a.uff", "no universal")],
)
def test_files_that_are_not_what_their_suffix_tells(tmp_path, name, message):
    (tmp_path / name).write_bytes(b"neither fish nor flesh " * 20)
    with pytest.raises(ZSpringError, match=message):
        read_recording(tmp_path / name)


@pytest.mark.parametrize("name, package, module", [("a.h5", "h5py", "h5py"), ("a.tdms", "npTDMS", "nptdms")])
def test_a_missing_package_is_named(tmp_path, monkeypatch, name, package, module):
    (tmp_path / name).write_bytes(b"")
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ZSpringError, match=rf'^{package} not installed: .* -m pip install "zspring\[bench\]"$'):
        read_recording(tmp_path / name)


def test_channels_of_other_lengths_are_cut_or_refused(tmp_path):
    savemat(tmp_path / "a.mat", {**VALUES, "force": VALUES["force"][:-3]})
    record = read(tmp_path / "a.mat", time={"rate": 200.0})
    assert record.remarks == [f"a.mat: channels end at different times: cut to {RECORD.time.size - 3} values"]
    savemat(tmp_path / "b.mat", {**VALUES, "force": VALUES["force"][::2]})
    with pytest.raises(ZSpringError, match=r"numbers of values differ .* the sampling rates must be equal"):
        read(tmp_path / "b.mat", time={"rate": 200.0})
    with pytest.raises(ZSpringError, match=r"a.mat: no time: \[time\] channel or rate, in Hz, tells it"):
        read(tmp_path / "a.mat")


def test_gaps_in_time_part_a_record(tmp_path):
    """Two seconds of it are lost: the others keep their times."""
    keep = (RECORD.time < 3) | (RECORD.time > 5)
    columns = {"time [s]": RECORD.time, "force [N]": VALUES["force"], "position [mm]": VALUES["position"]}
    record = read(write_text(tmp_path / "a.csv", {name: values[keep] for name, values in columns.items()}))
    assert [record.time[last - 1] for _, last in record.parts] == pytest.approx([2.995, RECORD.time[-1]])
    assert record.remarks == ["a.csv: 1 gaps in time"]
