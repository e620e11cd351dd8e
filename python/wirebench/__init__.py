"""Recordings, datasets, simulated tests and calibration of wirebench.

A thin module over libwirebench, whose header, wirebench.h, documents each number. Everything is in
SI units; NaN is an unknown value. Tables are dictionaries of NumPy arrays:

    import wirebench
    with wirebench.Recording("type1-L85-1.wbr.zst") as recording:
        force = recording.table("load")["force_N"]
    dataset = wirebench.align("type1-L85-1.wbr.zst")
    wire = wirebench.calibrate([dataset])
    print(wire.info.rigidity.value, wire.bend(20.0).residual_curvature_ratio)
    frame = dataset.table("shape").frame()   # with pandas

A failure raises wirebench.Error with the library's message. wirebench.Incomplete is a warning that
results were delivered, but something is missing or doubtful; wirebench.Remark is a warning of the
tool.
"""

import ctypes as _c
import json as _json
import os as _os
import sys as _sys
import types as _types
import warnings as _warnings
from collections.abc import Mapping as _Mapping

import numpy as _np

from . import _structs as _s

__all__ = ["Dataset", "Error", "Harness", "Incomplete", "Properties", "Recording", "Remark", "Table",
           "align", "calibrate", "revision", "solve_cantilever", "solve_three_point", "version"]


class Error(Exception):
    """A failure of the library; `status` is the code of enum wirebench_status."""

    def __init__(self, status, message):
        super().__init__(message)
        self.status = status


class Incomplete(UserWarning):
    """Results were delivered, but something is missing or doubtful."""


class Remark(UserWarning):
    """A warning of the tool."""


# WIREBENCH_LIBRARY names the file of a library that is not installed.
_lib = _c.CDLL(_os.environ.get("WIREBENCH_LIBRARY", "libwirebench.so.0"))
_s.declare(_lib)


def _text(value):
    return None if value is None else value.decode("utf-8", "replace")


def _path(path):
    return _os.fsencode(_os.fspath(path))


def _caller():
    """The stack level, seen from _check(), of the line that called this module."""
    level, frame = 2, _sys._getframe(2)
    while frame.f_back and frame.f_globals is globals():
        level, frame = level + 1, frame.f_back
    return level


def _check(status):
    """Raises or warns according to the status of the last call."""
    message = _text(_lib.wirebench_message())
    remarks = _text(_lib.wirebench_warnings())
    if status < 0:
        raise Error(status, message)
    for remark in remarks.splitlines():
        _warnings.warn(remark, Remark, stacklevel=_caller())
    if status > 0:
        _warnings.warn(message, Incomplete, stacklevel=_caller())


def _plain(value):
    """A struct as a namespace, without its size; arrays are cut to their used length."""
    if isinstance(value, bytes):
        return _text(value)
    if isinstance(value, _c.Array):
        return [_plain(item) for item in value]
    if not isinstance(value, _c.Structure):
        return value
    fields = {name: _plain(getattr(value, name)) for name, *_ in value._fields_ if name != "size"}
    for name in ("natural_shape", "parts", "backs"):
        if "n_" + name in fields:
            fields[name] = fields[name][:fields.pop("n_" + name)]
    return _types.SimpleNamespace(**fields)


def _described(struct, call, *arguments):
    filled = struct(size=_c.sizeof(struct))
    _check(call(*arguments, _c.byref(filled)))
    return _plain(filled)


def _array(pointer, n):
    if n == 0:
        return _np.empty(0, dtype=pointer._type_)
    return _np.ctypeslib.as_array(pointer, shape=(n,)).copy()


class Table(_Mapping):
    """Columns by name, NumPy arrays: float64, int64, or of str. `units` has each column's unit."""

    def __init__(self, handle):
        self._columns, self.units = {}, {}
        for index in range(_lib.wirebench_table_columns(handle)):
            column = _s.Column(size=_c.sizeof(_s.Column))
            _check(_lib.wirebench_table_column(handle, index, _c.byref(column)))
            if column.type == _s.REAL:
                values = _array(column.reals, column.n)
            elif column.type == _s.INTEGER:
                values = _array(column.integers, column.n)
            else:
                values = _np.array([_text(column.texts[i]) for i in range(column.n)], dtype=object)
            self._columns[_text(column.name)] = values
            self.units[_text(column.name)] = _text(column.unit)
        self.rows = _lib.wirebench_table_rows(handle)

    def __getitem__(self, name):
        return self._columns[name]

    def __iter__(self):
        return iter(self._columns)

    def __len__(self):
        return len(self._columns)

    def frame(self):
        """The table as a pandas DataFrame."""
        import pandas
        return pandas.DataFrame(self._columns)


class _Handle:
    """Owner of a handle of the library, which is freed with the object."""

    _free = None

    def __init__(self, make, *arguments):
        self._handle = _c.c_void_p()
        _check(make(_c.byref(self._handle), *arguments))

    @classmethod
    def _made(cls, make, *arguments):
        made = cls.__new__(cls)
        _Handle.__init__(made, make, *arguments)
        return made

    def close(self):
        handle, self._handle = getattr(self, "_handle", None), None
        if handle:
            type(self)._free(handle)

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    def __del__(self):
        self.close()

    @property
    def _open(self):
        if not self._handle:
            raise ValueError(type(self).__name__ + " was closed")
        return self._handle


class Recording(_Handle):
    """A recording, NAME.wbr or NAME.wbr.zst."""

    _free = _lib.wirebench_recording_close

    def __init__(self, path):
        super().__init__(_lib.wirebench_recording_open, _path(path))

    @property
    def info(self):
        """Contents and completeness: struct wirebench_recording_info."""
        return _described(_s.RecordingInfo, _lib.wirebench_recording_describe, self._open)

    @property
    def streams(self):
        """A struct wirebench_stream for each instrument; role is "load", "mocap" or "stage"."""
        found = []
        for index in range(self.info.n_streams):
            stream = _described(_s.Stream, _lib.wirebench_recording_stream, self._open, index)
            stream.role = ("load", "mocap", "stage")[stream.role]
            found.append(stream)
        return found

    @property
    def problems(self):
        """Missing or damaged parts, as sentences."""
        return [_text(_lib.wirebench_recording_problem(self._open, index))
                for index in range(self.info.n_problems)]

    def meta(self, key):
        """A text of the meta data, such as "specimen" or "rig"; None if there is none."""
        return _text(_lib.wirebench_recording_meta(self._open, key.encode()))

    def table(self, name):
        """Table "load", "mocap", "stage", "events" or "clock"."""
        table = _c.c_void_p()
        _check(_lib.wirebench_recording_table(self._open, name.encode(), _c.byref(table)))
        return Table(table)


class Dataset(_Handle):
    """A test as force over deflection and shapes: a folder written by `wirebench align`. align()
    makes one from a recording without a folder."""

    _free = _lib.wirebench_dataset_close

    def __init__(self, folder):
        super().__init__(_lib.wirebench_dataset_read, _path(folder))

    @property
    def info(self):
        """struct wirebench_dataset_info; kind is "cantilever", "three-point" or "tensile"."""
        info = _described(_s.DatasetInfo, _lib.wirebench_dataset_describe, self._open)
        info.kind = ("cantilever", "three-point", "tensile")[info.kind]
        return info

    def table(self, name="force_deflection"):
        """Table "force_deflection" or "shape"."""
        table = _c.c_void_p()
        _check(_lib.wirebench_dataset_table(self._open, name.encode(), _c.byref(table)))
        return Table(table)

    @property
    def document(self):
        """dataset.json: origin of the data, and corrections with their sizes."""
        return _json.loads(_text(_lib.wirebench_dataset_json(self._open)))


class Properties(_Handle):
    """Properties of a wire: from the numbers of a law, from a file, or calibrated."""

    _free = _lib.wirebench_properties_destroy

    def __init__(self, outer_diameter, youngs_modulus=0.0, yield_stress=0.0,
                 strength_coefficient=0.0, hardening_exponent=0.0, *, parts=(), kinematic_share=0.0,
                 poissons_ratio=0.0, mass_per_length=0.0, is_combined=False, saturation=0.0,
                 rate=0.0, backs=()):
        """Ludwik's law, parallel parts [(modulus, yield strain), ...], or Chaboche's with back
        stresses [(modulus, recovery), ...]: struct wirebench_law."""
        if len(parts) > _s.MOST_PARTS:
            raise ValueError("at most %d parts, not %d" % (_s.MOST_PARTS, len(parts)))
        if len(backs) > _s.MOST_BACKS:
            raise ValueError("at most %d back stresses, not %d" % (_s.MOST_BACKS, len(backs)))
        law = _s.Law(size=_c.sizeof(_s.Law), outer_diameter=outer_diameter,
                     youngs_modulus=youngs_modulus, yield_stress=yield_stress,
                     strength_coefficient=strength_coefficient,
                     hardening_exponent=hardening_exponent, n_parts=len(parts),
                     kinematic_share=kinematic_share, poissons_ratio=poissons_ratio,
                     mass_per_length=mass_per_length, is_combined=bool(is_combined),
                     saturation=saturation, rate=rate, n_backs=len(backs))
        for i, (modulus, recovery) in enumerate(backs):
            law.backs[i] = _s.Back(modulus, recovery)
        for i, (modulus, yield_strain) in enumerate(parts):
            law.parts[i] = _s.Part(modulus, yield_strain)
        super().__init__(_lib.wirebench_properties_create, _c.byref(law))

    @classmethod
    def read(cls, path_or_name):
        """A properties file, a wire file, or a shipped wire by its name, "type1"."""
        return cls._made(_lib.wirebench_properties_read, _path(path_or_name))

    @property
    def info(self):
        """struct wirebench_properties_info"""
        return _described(_s.PropertiesInfo, _lib.wirebench_properties_describe, self._open)

    @property
    def text(self):
        """The text of PROPERTIES.yaml of calibrated properties; None for others."""
        return _text(_lib.wirebench_properties_text(self._open))

    def moments(self, curvature):
        """Bending moments (N m) of a first loading at these curvatures (1/m)."""
        curvature = _np.asarray(curvature, dtype=_np.float64)
        given = _np.ascontiguousarray(curvature).ravel()
        found = _np.empty_like(given)
        _check(_lib.wirebench_moments(self._open, given.size, _s.pointer(given),
                                      _s.pointer(found)))
        return found.reshape(curvature.shape)

    def bend(self, largest):
        """rigidity, residual_curvature_ratio and loop_energy of bending to `largest` (1/m)."""
        return _described(_s.Bending, _lib.wirebench_bend, self._open, largest)


class Harness(_Handle):
    """A branched harness that is assembled step by step: a harness file, or a shipped one by its
    name, "door".

    A step that finds no equilibrium gives the warning Incomplete; one that is not possible raises
    Error and changes nothing.
    """

    _free = _lib.wirebench_harness_destroy
    _kinds = ("hang", "mount", "move", "release", "take_off")

    def __init__(self, path_or_name, *, is_elastic=False, element_length=0.0):
        settings = _s.HarnessSettings(size=_c.sizeof(_s.HarnessSettings),
                                      is_elastic=bool(is_elastic), element_length=element_length)
        super().__init__(_lib.wirebench_harness_read, _path(path_or_name), _c.byref(settings))

    @property
    def info(self):
        """The current state: struct wirebench_harness_info."""
        return _described(_s.HarnessInfo, _lib.wirebench_harness_describe, self._open)

    @property
    def planned_steps(self):
        """The steps of the file, for take_step()."""
        steps = []
        for index in range(self.info.n_steps):
            steps.append(_s.HarnessStep(size=_c.sizeof(_s.HarnessStep)))
            _check(_lib.wirebench_harness_planned_step(self._open, index, _c.byref(steps[-1])))
        return steps

    def take_step(self, step):
        """A step of planned_steps."""
        _check(_lib.wirebench_harness_take_step(self._open, _c.byref(step)))

    def _take(self, kind, item=None, position=None, direction=None, up=None):
        def vector(given):
            return (_c.c_double * 3)(*(given if given is not None else (0.0, 0.0, 0.0)))

        self.take_step(_s.HarnessStep(size=_c.sizeof(_s.HarnessStep), kind=self._kinds.index(kind),
                                      item=None if item is None else item.encode(),
                                      position=vector(position), direction=vector(direction),
                                      up=vector(up)))

    def hang(self):
        """The weight acts from now on."""
        self._take("hang")

    def mount(self, item, position, direction=None, up=None):
        """An item is held and moved to its place (m)."""
        self._take("mount", item, position, direction, up)

    def move(self, item, position, direction=None, up=None):
        """A mounted item is moved (m)."""
        self._take("move", item, position, direction, up)

    def release(self, item):
        """An item is let go."""
        self._take("release", item)

    def take_off(self):
        """All items and the weight are let go: the last step."""
        self._take("take_off")

    def undo(self, n=1):
        """Undoes the last n steps and restored snapshots."""
        _check(_lib.wirebench_harness_undo(self._open, n))

    def snapshot(self, name):
        """Keeps the state under a name."""
        _check(_lib.wirebench_harness_snapshot(self._open, name.encode()))

    def restore(self, name):
        """Returns to the state that was kept under a name."""
        _check(_lib.wirebench_harness_restore(self._open, name.encode()))

    def table(self, name="shapes"):
        """Table "shapes", "items", "forces" or "branches" of the current state."""
        table = _c.c_void_p()
        _check(_lib.wirebench_harness_table(self._open, name.encode(), _c.byref(table)))
        return Table(table)


def version():
    """The library's release."""
    return _text(_lib.wirebench_version())


def revision():
    """The source revision of the library's build."""
    return _text(_lib.wirebench_revision())


def _options(options):
    """Converts {"data-step-mm": 2} to the library's form, "data-step-mm=2"."""
    given = [name if value is True else "%s=%s" % (name, value)
             for name, value in (options or {}).items()]
    return (_c.c_char_p * (len(given) + 1))(*[text.encode() for text in given], None)


def align(path, *, rig=None, specimen=None, options=None):
    """Makes the Dataset of a recording like `wirebench align`.

    rig, specimen: paths of files used in place of the recorded ones. options: other options of the
    command by name, {"row-rate": 50}.
    """
    alignment = _s.Alignment(size=_c.sizeof(_s.Alignment),
                             rig=None if rig is None else _path(rig),
                             specimen=None if specimen is None else _path(specimen),
                             options=_options(options))
    return Dataset._made(_lib.wirebench_dataset_align, _path(path), _c.byref(alignment))


def _solve(call, properties, test, deflection, result, shapes=0):
    """Fills all arrays of the result's struct, and returns them with the deflections."""
    deflection = _np.ascontiguousarray(deflection, dtype=_np.float64).ravel()
    arrays = {"deflection": deflection}
    for name, kind in result._fields_:
        if name in ("size", "n_done") or (name.startswith("shape_") and shapes == 0):
            continue
        kind = _np.intc if kind is _s.INTS else _np.float64
        shape = (deflection.size, shapes) if name.startswith("shape_") else deflection.size
        arrays[name] = _np.empty(shape, dtype=kind)
        setattr(result, name, _s.pointer(arrays[name]))
    _check(call(properties._open, _c.byref(test), deflection.size, _s.pointer(deflection),
                _c.byref(result)))
    arrays["slack"] = arrays["slack"].astype(bool)
    return _types.SimpleNamespace(n_done=result.n_done, **arrays)


def solve_cantilever(properties, length, deflection, *, strand_length=0.0, counterweight=0.0,
                     gravity=0.0, natural_shape=(), n_elements=0, positions=()):
    """Moves the tip of a virgin wire through deflections (m), in order.

    Returns arrays: deflection, force, tension, tip_x, tip_angle, root_moment, slack, and with
    `positions` (arc lengths, m) shape_x and shape_y, a row for each deflection; n_done rows were
    computed, later ones are NaN. See struct wirebench_cantilever.
    """
    if len(natural_shape) > _s.MOST_SHAPE:
        raise ValueError("at most %d numbers of a natural shape" % _s.MOST_SHAPE)
    positions = _np.ascontiguousarray(positions, dtype=_np.float64).ravel()
    test = _s.Cantilever(size=_c.sizeof(_s.Cantilever), length=length, strand_length=strand_length,
                         counterweight=counterweight, gravity=gravity,
                         n_natural_shape=len(natural_shape), n_elements=n_elements,
                         n_positions=positions.size, positions=_s.pointer(positions))
    for i, number in enumerate(natural_shape):
        test.natural_shape[i] = number
    result = _s.CantileverResult(size=_c.sizeof(_s.CantileverResult))
    return _solve(_lib.wirebench_solve_cantilever, properties, test, deflection, result,
                  positions.size)


def solve_three_point(properties, span, deflection, *, overhang=0.0, roller_radius=0.0,
                      nose_radius=0.0, friction=0.0, compliance=0.0, n_elements=0):
    """The same for three-point bending, by the nose's travel after first contact (m).

    Returns arrays: deflection, force, travel, middle_moment, middle_curvature, slack; and n_done. See
    struct wirebench_three_point.
    """
    test = _s.ThreePoint(size=_c.sizeof(_s.ThreePoint), span=span, overhang=overhang,
                         roller_radius=roller_radius, nose_radius=nose_radius, friction=friction,
                         compliance=compliance, n_elements=n_elements)
    result = _s.ThreePointResult(size=_c.sizeof(_s.ThreePointResult))
    return _solve(_lib.wirebench_solve_three_point, properties, test, deflection, result)


def calibrate(datasets, method=None, *, threads=0, options=None, progress=None):
    """Calibrates on datasets of one wire like `wirebench calibrate`, and returns Properties.

    method: "cycle", "paper" or None, the default. options: those of the command by name,
    {"data-step-mm": 2}; True for one without a value. progress(done, all) is called repeatedly;
    returning False stops.
    """
    methods = {None: 0, "cycle": 1, "paper": 2}
    if method not in methods:
        raise ValueError("method: expected cycle, paper or None, not %r" % (method,))
    datasets = list(datasets)
    handles = (_c.c_void_p * len(datasets))(*[dataset._open.value for dataset in datasets])
    raised = []

    def report(_context, done, all_):
        try:
            return 0 if progress(done, all_) is False else 1
        except BaseException as exception:  # exceptions cannot pass through C
            raised.append(exception)
            return 0

    calibration = _s.Calibration(size=_c.sizeof(_s.Calibration), method=methods[method],
                                 threads=threads, options=_options(options),
                                 progress=_s.PROGRESS(report) if progress else _s.PROGRESS())
    with _warnings.catch_warnings(record=True) as given_warnings:
        _warnings.simplefilter("always")
        try:
            made = Properties._made(_lib.wirebench_calibrate, handles, len(datasets),
                                    _c.byref(calibration))
        except Error:
            if raised:
                raise raised[0] from None
            raise
    if raised:
        raise raised[0]
    for warning in given_warnings:
        _warnings.warn(str(warning.message), warning.category, stacklevel=2)
    return made
