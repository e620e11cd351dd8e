"""The structs and functions of wirebench.h for ctypes.

tests/library/test_python.py compares sizes and offsets with a compiler's.
"""

import ctypes as c

REAL, INTEGER, TEXT = range(3)
MOST_SHAPE = 4
MOST_PARTS = 12
MOST_BACKS = 3

DOUBLES = c.POINTER(c.c_double)
INTS = c.POINTER(c.c_int)
PROGRESS = c.CFUNCTYPE(c.c_int, c.c_void_p, c.c_int, c.c_int)


def pointer(array):
    """Pointer to the numbers of a contiguous NumPy array."""
    return array.ctypes.data_as(INTS if array.dtype.kind == "i" else DOUBLES)


def _struct(name, *fields):
    return type(name, (c.Structure,), {"_fields_": list(fields)})


def _doubles(names):
    return [(name, c.c_double) for name in names.split()]


def _ints(names):
    return [(name, c.c_int) for name in names.split()]


_SIZE = ("size", c.c_size_t)

Column = _struct("Column", _SIZE, ("name", c.c_char_p), ("unit", c.c_char_p), ("type", c.c_int),
                 ("n", c.c_size_t), ("reals", DOUBLES), ("integers", c.POINTER(c.c_int64)),
                 ("texts", c.POINTER(c.c_char_p)))

RecordingInfo = _struct("RecordingInfo", _SIZE, ("sha256", c.c_char * 65),
                        *_ints("is_virtual is_whole n_problems n_streams"),
                        ("first_ns", c.c_int64), ("duration", c.c_double),
                        ("chunks", c.c_uint64), ("damaged_chunks", c.c_uint64),
                        ("events", c.c_uint64))

Stream = _struct("Stream", _SIZE, ("id", c.c_int), ("role", c.c_int), ("address", c.c_char * 160),
                 ("protocol", c.c_char * 32), ("chunks", c.c_uint64), ("bytes", c.c_uint64),
                 ("samples", c.c_uint64), *_doubles("rate longest_silence"))

DatasetInfo = _struct("DatasetInfo", _SIZE, ("wire", c.c_char_p), *_ints("kind sample"),
                      *_doubles("length outer_diameter mass_per_length strand_length "
                                "counterweight gravity"),
                      ("n_natural_shape", c.c_int), ("natural_shape", c.c_double * MOST_SHAPE),
                      *_ints("is_follower is_virtual is_simulation is_complete"))

Part = _struct("Part", *_doubles("modulus yield_strain"))
Back = _struct("Back", *_doubles("modulus recovery"))
_CHABOCHE = (*_doubles("saturation rate"), *_ints("n_backs is_combined"),
             ("backs", Back * MOST_BACKS))

_LUDWIK = _doubles("youngs_modulus yield_stress strength_coefficient hardening_exponent")

Alignment = _struct("Alignment", _SIZE, ("rig", c.c_char_p), ("specimen", c.c_char_p),
                    ("options", c.POINTER(c.c_char_p)))

Law = _struct("Law", _SIZE, *_doubles("outer_diameter mass_per_length poissons_ratio"), *_LUDWIK,
              ("n_parts", c.c_int), ("parts", Part * MOST_PARTS),
              ("kinematic_share", c.c_double), *_CHABOCHE)

Estimate = _struct("Estimate", *_doubles("value low high candidates_low candidates_high"))

PropertiesInfo = _struct("PropertiesInfo", _SIZE, ("wire", c.c_char_p), ("method", c.c_char_p),
                         *_doubles("outer_diameter mass_per_length poissons_ratio"), *_LUDWIK,
                         ("deviation", c.c_double * 4), ("n_parts", c.c_int),
                         ("parts", Part * MOST_PARTS),
                         *_doubles("kinematic_share rms largest_curvature"),
                         ("rigidity", Estimate), ("residual_curvature_ratio", Estimate),
                         *_ints("n_samples is_rule_supported is_virtual is_simulation"),
                         *_CHABOCHE, *_doubles("law_youngs_modulus law_yield_stress"),
                         ("deflection_springback", Estimate))

Bending = _struct("Bending", _SIZE, *_doubles("rigidity residual_curvature_ratio loop_energy"))

Cantilever = _struct("Cantilever", _SIZE,
                     *_doubles("length strand_length counterweight gravity"),
                     ("n_natural_shape", c.c_int), ("natural_shape", c.c_double * MOST_SHAPE),
                     ("n_elements", c.c_int), ("n_positions", c.c_size_t),
                     ("positions", DOUBLES))

CantileverResult = _struct("CantileverResult", _SIZE,
                           *[(name, DOUBLES)
                             for name in "force tension tip_x tip_angle root_moment".split()],
                           ("slack", INTS), ("shape_x", DOUBLES), ("shape_y", DOUBLES),
                           ("n_done", c.c_size_t))

ThreePoint = _struct("ThreePoint", _SIZE,
                     *_doubles("span overhang roller_radius nose_radius friction compliance"),
                     ("n_elements", c.c_int))

ThreePointResult = _struct("ThreePointResult", _SIZE,
                           *[(name, DOUBLES)
                             for name in "force travel middle_moment middle_curvature".split()],
                           ("slack", INTS), ("n_done", c.c_size_t))

HarnessSettings = _struct("HarnessSettings", _SIZE, ("is_elastic", c.c_int),
                          ("element_length", c.c_double))

HarnessStep = _struct("HarnessStep", _SIZE, ("kind", c.c_int), ("item", c.c_char_p),
                      *[(name, c.c_double * 3) for name in "position direction up".split()])

HarnessInfo = _struct("HarnessInfo", _SIZE, ("name", c.c_char_p), ("title", c.c_char_p),
                      *_ints("n_branches n_items n_steps state"), ("step", c.c_char_p),
                      ("is_converged", c.c_int), ("fraction", c.c_double), ("n_snaps", c.c_int),
                      *_doubles("elastic plastic"))

Calibration = _struct("Calibration", _SIZE, *_ints("method threads"),
                      ("options", c.POINTER(c.c_char_p)), ("progress", PROGRESS),
                      ("context", c.c_void_p))

# By their names in the header.
STRUCTS = {"column": Column, "recording_info": RecordingInfo, "stream": Stream,
           "dataset_info": DatasetInfo, "alignment": Alignment, "part": Part, "back": Back, "law": Law,
           "estimate": Estimate, "properties_info": PropertiesInfo, "bending": Bending, "cantilever": Cantilever,
           "cantilever_result": CantileverResult, "three_point": ThreePoint,
           "three_point_result": ThreePointResult, "harness_settings": HarnessSettings,
           "harness_step": HarnessStep, "harness_info": HarnessInfo, "calibration": Calibration}

_HANDLE, _OUT = c.c_void_p, c.POINTER(c.c_void_p)

# Result, then arguments; pointers to structs accept byref() of any struct.
FUNCTIONS = {
    "version": (c.c_char_p,),
    "revision": (c.c_char_p,),
    "status_text": (c.c_char_p, c.c_int),
    "message": (c.c_char_p,),
    "warnings": (c.c_char_p,),
    "table_rows": (c.c_size_t, _HANDLE),
    "table_columns": (c.c_int, _HANDLE),
    "table_column": (c.c_int, _HANDLE, c.c_int, c.POINTER(Column)),
    "table_find": (c.c_int, _HANDLE, c.c_char_p, c.POINTER(Column)),
    "recording_open": (c.c_int, _OUT, c.c_char_p),
    "recording_close": (None, _HANDLE),
    "recording_describe": (c.c_int, _HANDLE, c.POINTER(RecordingInfo)),
    "recording_stream": (c.c_int, _HANDLE, c.c_int, c.POINTER(Stream)),
    "recording_problem": (c.c_char_p, _HANDLE, c.c_int),
    "recording_meta": (c.c_char_p, _HANDLE, c.c_char_p),
    "recording_table": (c.c_int, _HANDLE, c.c_char_p, _OUT),
    "dataset_read": (c.c_int, _OUT, c.c_char_p),
    "dataset_align": (c.c_int, _OUT, c.c_char_p, c.POINTER(Alignment)),
    "dataset_close": (None, _HANDLE),
    "dataset_describe": (c.c_int, _HANDLE, c.POINTER(DatasetInfo)),
    "dataset_table": (c.c_int, _HANDLE, c.c_char_p, _OUT),
    "dataset_json": (c.c_char_p, _HANDLE),
    "properties_create": (c.c_int, _OUT, c.POINTER(Law)),
    "properties_read": (c.c_int, _OUT, c.c_char_p),
    "properties_destroy": (None, _HANDLE),
    "properties_describe": (c.c_int, _HANDLE, c.POINTER(PropertiesInfo)),
    "properties_text": (c.c_char_p, _HANDLE),
    "moments": (c.c_int, _HANDLE, c.c_size_t, DOUBLES, DOUBLES),
    "bend": (c.c_int, _HANDLE, c.c_double, c.POINTER(Bending)),
    "solve_cantilever": (c.c_int, _HANDLE, c.POINTER(Cantilever), c.c_size_t, DOUBLES,
                         c.POINTER(CantileverResult)),
    "solve_three_point": (c.c_int, _HANDLE, c.POINTER(ThreePoint), c.c_size_t, DOUBLES,
                          c.POINTER(ThreePointResult)),
    "harness_read": (c.c_int, _OUT, c.c_char_p, c.POINTER(HarnessSettings)),
    "harness_destroy": (None, _HANDLE),
    "harness_planned_step": (c.c_int, _HANDLE, c.c_int, c.POINTER(HarnessStep)),
    "harness_take_step": (c.c_int, _HANDLE, c.POINTER(HarnessStep)),
    "harness_undo": (c.c_int, _HANDLE, c.c_int),
    "harness_snapshot": (c.c_int, _HANDLE, c.c_char_p),
    "harness_restore": (c.c_int, _HANDLE, c.c_char_p),
    "harness_describe": (c.c_int, _HANDLE, c.POINTER(HarnessInfo)),
    "harness_table": (c.c_int, _HANDLE, c.c_char_p, _OUT),
    "calibrate": (c.c_int, _OUT, _OUT, c.c_size_t, c.POINTER(Calibration)),
}


def declare(library):
    """Sets the types of the library's functions."""
    for name, (result, *arguments) in FUNCTIONS.items():
        function = getattr(library, "wirebench_" + name)
        function.restype, function.argtypes = result, arguments
