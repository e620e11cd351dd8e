#!/bin/bash
# `wirebench solve harness` and `quicklook`: the shipped harness on the terminal, as JSON and as files, and what goes
# wrong. Usage: harness.sh WIREBENCH SOURCE_ROOT
. "$2/tests/cli/reports.sh"
root=$2
export WIREBENCH_DATA=$root
cd "$folder" || exit 1

"$wirebench" solve harness small -o out >said 2>warned || fail "solve harness ended with $?"
for part in 'mount C1' 'least radius' 'LIMIT EXCEEDED (10 N)' 'simulation, elastoplastic' \
    'residual shape is up to' 'depend on GJ, which is not measured'; do
    grep -qF "$part" said || fail "'$part' is not said: $(cat said)"
done
# Its wires were fitted on loading only.
[ "$(grep -c 'step [67], .*fitted on loading only: trunk (bundle-7.yaml), lead' warned)" -eq 2 ] ||
    fail "what is released is not warned of: $(cat warned)"
[ "$(ls out)" = "$(printf 'forces.csv\nharness.json\nshapes.csv')" ] || fail "files: $(ls out)"
grep -q 'simulation, elastoplastic' out.svg || fail 'the drawing does not say what it is'
"$wirebench" info out >kind && grep -q 'solve harness' kind || fail "info out: $(cat kind)"
"$wirebench" solve harness small --json >out.json 2>/dev/null || fail 'solve harness --json'
cmp -s out.json out/harness.json || fail '--json and harness.json differ'

# The numbers of the tables are those of the JSON object; the shape continues from branch to branch.
python3 - out <<'PYTHON' || fail 'the tables do not agree'
import csv, json, math, sys
result = json.load(open(sys.argv[1] + "/harness.json"))
assert result["converged"] and len(result["steps"]) == 7
forces = list(csv.DictReader(open(sys.argv[1] + "/forces.csv")))
for row in forces:
    step = result["steps"][int(row["step"]) - 1]
    item = next(i for i in step["forces"] if i["name"] == row["item"])
    assert float(row["force_N"]) == item["force_N"]
    along, across, up = (float(row["force_%s_N" % k]) for k in ("along", "across", "up"))
    assert math.isclose(math.hypot(along, across, up), item["force_N"], rel_tol=1e-12, abs_tol=1e-15)
    assert item["largest_force_N"] >= item["force_N"] * (1 - 1e-12)
assert {row["item"] for row in forces} == {"R", "C1", "K1", "K2"}
shapes = list(csv.DictReader(open(sys.argv[1] + "/shapes.csv")))
steps = [row["step"] for row in shapes]
assert sorted(set(steps)) == ["1", "2", "3", "4", "5", "6", "7", "natural"]
place = lambda row: [float(row[k]) for k in ("x_mm", "y_mm", "z_mm")]
for step in set(steps):
    ends = {}
    for row in shapes:
        if row["step"] == step:
            ends.setdefault(row["branch"], []).append(row)
    assert math.dist(place(ends["B1"][0]), [0, 0, 0]) == 0
    for branch in ("B2", "B3"):
        assert math.dist(place(ends["B1"][-1]), place(ends[branch][0])) < 1e-9
    for rows in ends.values():
        way = sum(math.dist(place(a), place(b)) for a, b in zip(rows, rows[1:]))
        assert math.isclose(way, float(rows[-1]["s_mm"]), rel_tol=2e-3)
natural = [row for row in shapes if row["step"] == "natural"]
assert all(float(row["moment_N_mm"]) == 0 for row in natural)
PYTHON

"$wirebench" solve harness small --law elastic -o elastic >said 2>warned || fail 'elastic'
[ ! -s warned ] || fail "elastic: $(cat warned)"
grep -q 'returns to its stress-free shape' said || fail "elastic: $(cat said)"
grep -q 'virtual rig' said && fail 'a shipped wire is not of a virtual rig'
python3 - elastic <<'PYTHON' || fail 'an elastic harness does not return'
import json, sys
result = json.load(open(sys.argv[1] + "/harness.json"))
assert result["law"] == "elastic" and result["residual_shape"]["distance_mm"] < 1e-5
PYTHON

"$wirebench" solve harness small --law elastic --vtk vtk -o plain --no-figure >said || fail '--vtk'
[ ! -e plain.svg ] || fail '--no-figure draws a figure'
[ "$(ls vtk | grep -c 'small-000[0-7].vtu')" -eq 8 ] && [ "$(grep -c small-000 vtk/small.pvd)" -eq 8 ] ||
    fail "VTK files: $(ls vtk)"
for array in position_mm curvature_1_m moment_N_mm torque_N_mm tension_N branch; do
    grep -aq "Name=\"$array\"" vtk/small-0003.vtu || fail "no $array in the VTK files"
done
# A ring of twelve points around each place, with the radius of the wire.
python3 - vtk/small-0003.vtu plain/shapes.csv <<'PYTHON' || fail 'the VTK tubes are not around the wires'
import csv, math, re, struct, sys
raw = open(sys.argv[1], "rb").read()
begin = raw.index(b"_", raw.index(b'encoding="raw"')) + 1
begin += int(re.search(rb'Name="position_mm"[^>]*offset="(\d+)"', raw).group(1))
(size,) = struct.unpack_from("<Q", raw, begin)
points = list(struct.iter_unpack("<3d", raw[begin + 8 : begin + 8 + size]))
places = [row for row in csv.DictReader(open(sys.argv[2])) if row["step"] == "3"]
assert len(points) == 12 * len(places)
for i, row in enumerate(places):
    centre = [float(row[k]) for k in ("x_mm", "y_mm", "z_mm")]
    radius = 2.3 if row["branch"] == "B1" else 0.7
    for k in range(12):
        point, opposite = points[12 * i + k], points[12 * i + (k + 6) % 12]
        assert math.isclose(math.dist(point, centre), radius, rel_tol=1e-9)
        assert math.isclose(math.dist(point, opposite), 2 * radius, rel_tol=1e-9)
PYTHON

# Frames are shapes between the steps, at the same times in the table and for ParaView; the steps stay.
"$wirebench" solve harness small --law elastic --frames 4 --vtk films -o framed --no-figure >said ||
    fail '--frames'
python3 - plain framed films/small.pvd <<'PYTHON' || fail 'the frames are wrong'
import re, sys
for table in "forces", "shapes":
    plain, framed = ([line.split(",", 1) for line in open("%s/%s.csv" % (f, table))] for f in sys.argv[1:3])
    times = list(dict.fromkeys(row[0] for row in framed[1:]))
    whole = {row[0] for row in plain[1:]}
    assert [row for row in framed[1:] if row[0] in whole] == plain[1:]
    for step in range(7):
        between = [float(t) for t in times if t != "natural" and step < float(t) < step + 1]
        assert 1 <= len(between) <= 3 and between == sorted(between), (step, between)
    if table == "forces":
        of_forces = times
assert times == ["natural"] + of_forces
listed = re.findall('timestep="([^"]*)"', open(sys.argv[3]).read())
assert listed == ["0"] + times[1:], (listed, times)
PYTHON
cmp -s plain/harness.json framed/harness.json || fail '--frames changes the results'

# A properties file of `calibrate` is a wire, with unloading and a range of curvatures.
sed "s|wire: type3|wire: $root/docs/cards/type1.yaml|" "$root/fixtures/harnesses/small.yaml" >own.yaml
"$wirebench" solve harness own.yaml -o own >said 2>warned || fail "properties: $(cat warned)"
grep -q 'only: trunk (bundle-7.yaml);' warned || fail "a calibrated wire is warned of: $(cat warned)"
grep -q 'calibrated on a virtual rig: lead;' said || fail 'a virtual rig is not named'
grep -q 'virtual rig' own.svg || fail 'a virtual rig is not named in the drawing'
sed 's/least_radius_mm: 40/least_radius_mm: 200/' own.yaml >tight.yaml
"$wirebench" solve harness tight.yaml --law elastic >tight
grep -q '^ *B1 *bend radius down to [0-9.]* mm  LIMIT EXCEEDED (200 mm)' tight || fail "the radius's limit: $(cat tight)"
grep -q 'B[23].* bent beyond the calibration' said || fail "the range is not named: $(cat said)"

# So is what `calibrate` writes for a computed bundle, with its law, mass and diameter.
"$wirebench" calibrate "$root/simulations/7-type3" -o taped.yaml --no-figure >said 2>&1 || fail "calibrate: $(cat said)"
sed 's|wire: bundle-7|wire: ./taped.yaml|' "$root/fixtures/harnesses/small.yaml" >taped-harness.yaml
"$wirebench" solve harness taped-harness.yaml --law elastic --json >out.json 2>warned || fail "a bundle: $(cat warned)"
python3 - out.json taped.yaml <<'PYTHON' || fail 'the wire is not the calibrated bundle'
import json, math, re, sys
wire = json.load(open(sys.argv[1]))["wires"][0]
value = lambda key: float(re.search(r"^%s: (\S+)" % key, open(sys.argv[2]).read(), re.M).group(1))
assert wire["file"] == "taped.yaml" and wire["mass_per_length_kg_m"] == value("mass_per_length_kg_m")
assert wire["outer_diameter_mm"] == value("outer_diameter_mm")
rigidity = value("youngs_modulus_MPa") * math.pi * value("outer_diameter_mm") ** 4 / 64
assert math.isclose(wire["flexural_rigidity_N_mm2"], rigidity, rel_tol=1e-9)
PYTHON

# Bands from the specimens of a wire, beside one without: the same bytes again, and none left behind.
cat >bands.yaml <<YAML
kind: harness
name: bands
wires:
  - {name: lead, wire: $root/docs/cards/type1.yaml}
  - {name: trunk, wire: bundle-7}
root: {name: R}
branches:
  - {name: B1, from: R, to: J, wire: trunk, length_mm: 80}
  - {name: B2, from: J, to: K1, wire: lead, length_mm: 90, angle_deg: 30}
connectors:
  - {name: K1, mass_g: 2}
steps: [hang, take_off]
YAML
"$wirebench" solve harness bands.yaml --uncertain --runs 40 -o bands >said 2>warned || fail "--uncertain: $(cat warned)"
for part in 'medians and 95 % bands of 40 runs; drawn from specimens: lead (3 of type1.yaml); taken as exact: trunk' \
    'of its nominal shape (at 90 mm)' 'residual shape: up to'; do
    grep -qF "$part" said || fail "--uncertain: '$part' is not said: $(cat said)"
done
"$wirebench" solve harness bands.yaml --uncertain --runs 40 --json >out.json 2>/dev/null || fail '--uncertain --json'
cmp -s out.json bands/harness.json || fail 'two runs of --uncertain differ'
"$wirebench" info --schema harness >harness.schema.json || fail 'no schema of harness.json'
python3 - bands harness.schema.json <<'PYTHON' || fail 'the bands are wrong'
import csv, json, math, sys
result = json.load(open(sys.argv[1] + "/harness.json"))
try:
    from jsonschema import Draft202012Validator
    Draft202012Validator(json.load(open(sys.argv[2]))).validate(result)
except ImportError:
    pass
bands = result["uncertainty"]
assert [w["specimens"] for w in bands["wires"]] == [3, 0] and bands["deviating_runs"] == []
moment = bands["steps"][0]["forces"][0]["moment_N_mm"]
nominal = result["steps"][0]["forces"][0]["moment_N_mm"]
assert moment["low"] < moment["median"] < moment["high"] and abs(moment["median"] / nominal - 1) < 0.02
near, far = bands["steps"][0]["branches"]
assert 0 <= near["distance_mm"] < far["distance_mm"] and 0 < far["median_distance_mm"] < far["distance_mm"]
assert bands["residual_distance_mm"]["low"] < result["residual_shape"]["distance_mm"]
rows = list(csv.DictReader(open(sys.argv[1] + "/bands.csv")))
assert {row["runs"] for row in rows} == {"40"} and {row["step"] for row in rows} == {"1", "2"}
row = next(r for r in rows if r["name"] == "R" and r["quantity"] == "moment_N_mm")
assert all(math.isclose(float(row[k]), moment[k], rel_tol=1e-12) for k in ("median", "low", "high"))
row = next(r for r in rows if r["name"] == "B2")
assert row["quantity"] == "distance_mm" and row["low"] == ""
assert math.isclose(float(row["high"]), far["distance_mm"], rel_tol=1e-12)
assert rows[-1]["quantity"] == "residual_distance_mm"
PYTHON
# The same in parts, here or as tasks of Slurm, of which complete ones are kept; parts of another seed are not.
"$wirebench" solve harness bands.yaml --uncertain --runs 40 --solve --workers 2 -o parts >said 2>warned ||
    fail "--solve: $(cat warned)"
cmp -s bands/harness.json parts/harness.json && cmp -s bands/bands.csv parts/bands.csv || fail 'parts give other bytes'
[ "$(ls parts.jobs | grep -c 'part-[12]-of-2$')" -eq 2 ] || fail "parts: $(ls parts.jobs)"
stat -c %y%i parts.jobs/part-*/part.json >before
"$wirebench" solve harness bands.yaml --uncertain --runs 40 --solve -o parts --force >said 2>&1 || fail 'again'
stat -c %y%i parts.jobs/part-*/part.json | cmp -s - before || fail 'complete parts are computed again'
ends_with 3 'run the same command again' solve harness bands.yaml --uncertain --runs 40 --slurm-dry-run -o tasks
for task in 1 2; do
    (cd tasks.jobs/slurm-1 && SLURM_ARRAY_TASK_ID=$task sh array.sh "$folder") || fail "task $task of Slurm"
done
"$wirebench" solve harness bands.yaml --uncertain --runs 40 --slurm -o tasks >said 2>warned || fail "--slurm: $(cat warned)"
cmp -s bands/harness.json tasks/harness.json || fail 'the tasks of Slurm give other bytes'
"$wirebench" solve harness bands.yaml --uncertain --runs 40 --seed 2 --solve -o parts --force >said 2>&1 || fail '--seed 2'
cmp -s bands/bands.csv parts/bands.csv && fail 'parts of another seed are taken'
ends_with 2 "--part: expected K/N" solve harness bands.yaml --uncertain --part 3/2 -o none
ends_with 2 'need --uncertain and -o' solve harness bands.yaml --uncertain --solve
ends_with 2 'remove --part' solve harness bands.yaml --uncertain --solve --part 1/2 -o none
[ ! -e none ] || fail 'a wrong part leaves a folder'

"$wirebench" solve harness bands.yaml -o bands --force >said 2>/dev/null || fail 'without --uncertain'
[ ! -e bands/bands.csv ] || fail 'bands of an earlier run are left'
ends_with 2 'no wire has it: trunk (bundle-7.yaml), lead (type3.yaml)' solve harness small --uncertain -o none
[ ! -e none ] || fail 'a harness without scatter leaves a folder'
ends_with 2 'expected at least 40' solve harness bands.yaml --uncertain --runs 30
ends_with 2 'only with --uncertain' solve harness small --seed 2
ends_with 2 'remove --uncertain' solve harness small --uncertain --follow

ends_with 1 --force solve harness small -o out
ends_with 1 --force solve harness small -o other --vtk vtk
ends_with 2 '--frames needs' solve harness small --frames 3
ends_with 0 found solve harness small -o out --force
ends_with 2 'HARNESS.yaml' solve harness
ends_with 1 'a wire file' solve harness "$root/fixtures/wires/type3.yaml"
ends_with 1 'wirebench solve harness' solve bundle "$root/fixtures/harnesses/small.yaml"
sed 's/at_mm: \[190, 0, 30\]/at_mm: [190, 0, 130]/' "$root/fixtures/harnesses/small.yaml" >far.yaml
ends_with 1 'far.yaml:20: at_mm: C1 to R: 230.2 mm apart, 200 mm of wire' solve harness far.yaml -o far
[ ! -e far ] || fail 'a rejected file leaves a folder'

# Steps as lines of JSON: each answer arrives before the next line is sent, forces are those of the
# file's steps, and a wrong line does not end the session.
"$wirebench" info --schema harness-answer >answer.schema.json || fail 'no schema of the answers'
python3 - "$wirebench" out answer.schema.json <<'PYTHON' || fail '--follow'
import json, subprocess, sys
try:
    from jsonschema import Draft202012Validator
    validator = Draft202012Validator(json.load(open(sys.argv[3])))
except ImportError:
    validator = None
expected = json.load(open(sys.argv[2] + "/harness.json"))["steps"]
lines = [
    "hang",
    {"mount": "C1", "at_mm": [190, 0, 30], "direction": [1, 0.2, 0.2]},
    {"mount": "K1", "at_mm": [420, -140, 60], "direction": [0.5, -1, 0]},
    {"mount": "K2", "at_mm": [430, 170, 20], "direction": [0.3, 1, 0]},
    {"move": "C1", "at_mm": [190, 20, 30]},
    {"release": "K1"},
    {"take_off": True},
]
session = subprocess.Popen([sys.argv[1], "solve", "harness", "small", "--follow"], text=True,
                           stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
def ask(line):
    session.stdin.write(json.dumps(line) + "\n")
    session.stdin.flush()
    answer = json.loads(session.stdout.readline())
    if validator:
        validator.validate(answer)
    return answer
def without(forces):
    return [{key: value for key, value in force.items() if key not in
             ("soft_torsion_force_N", "twist_sensitive")} for force in forces]
assert ask({"describe": True})["state"] == 0
for line, step in zip(lines, expected):
    answer = ask(line)
    for key in ("name", "converged", "increments", "plastic_mJ", "branches"):
        assert answer[key] == step[key], (key, answer[key], step[key])
    assert without(answer["forces"]) == without(step["forces"])
assert ask({"move": "C9", "at_mm": [0, 0, 0]})["error"].startswith("move: no connector")
again = ask({"undo": 3, "shapes": "all"})
assert again["state"] == 4 and without(again["forces"]) == without(expected[3]["forces"])
session.stdin.close()
assert session.stdout.read() == "" and session.wait() == 0
PYTHON
echo '{"quit": true}' | "$wirebench" solve harness small --follow >said 2>/dev/null || fail 'quit'
[ "$(cat said)" = '{"quit": true}' ] || fail "quit: $(cat said)"
printf '{"state": true}\0{"hang": true}\n' | "$wirebench" solve harness small --follow >said 2>/dev/null || fail 'NUL'
[ "$(cat said)" = '{"error": "control characters are not allowed", "state": 0}' ] || fail "NUL: $(cut -c1-200 said)"
echo '{"state": true}' | "$wirebench" solve harness small --follow >/dev/full 2>said
[ $? -eq 1 ] && grep -q 'cannot be written' said || fail "a full output: $(cat said)"
ends_with 2 '--follow writes no files' solve harness small --follow -o follow
ends_with 2 '--follow' solve bundle 7-type3 --follow
# A quick look: the shape, without a step.
"$wirebench" quicklook "$root/fixtures/harnesses/small.yaml" -o look >said 2>warned || fail "quicklook ended with $?"
[ ! -s warned ] || fail "quicklook: $(cat warned)"
for part in 'stress-free shape' 'C1           clip on B1 at 200 mm' ' 2  mount C1 at (190, 0, 30) mm' 'written to look'; do
    grep -qF "$part" said || fail "quicklook: '$part' is not said: $(cat said)"
done
[ "$(ls look)" = "$(printf 'shape.pdf\nshape.png\nshape.svg\nsummary.txt')" ] || fail "quicklook: $(ls look)"
grep -q 'small: stress-free shape' look/shape.svg || fail 'the quick look does not say what it is'
"$wirebench" quicklook fixtures/harnesses/small.yaml -o look --force --json >said || fail 'quicklook --json'
python3 - said <<'PYTHON' || fail 'the quick look as JSON'
import json, sys
look = json.load(open(sys.argv[1]))
assert look["length_mm"] == 750 and len(look["steps"]) == 7
assert [i["name"] for i in look["items"]] == ["R", "K1", "K2", "C1"]
assert look["low_mm"][0] == 0 and abs(look["high_mm"][1] - 125) < 1e-9
PYTHON
ends_with 1 --force quicklook fixtures/harnesses/small.yaml -o look
ends_with 2 'figures go: -o DIR' quicklook fixtures/harnesses/small.yaml
sed 's/length_mm: 200/length_mm: long/' "$root/fixtures/harnesses/small.yaml" >wrong.yaml
ends_with 1 'wrong.yaml:11: length_mm' quicklook wrong.yaml -o wrong
ends_with 1 'wrong.yaml:11: length_mm' solve harness wrong.yaml
[ ! -e wrong ] || fail 'a rejected file leaves a folder'
finish 'solve harness'
