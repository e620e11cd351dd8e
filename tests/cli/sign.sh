#!/bin/bash
# `report --sign` and `report --check` with a key of their own: what is signed, what is noticed.
# Usage: sign.sh WIREBENCH
. "$(dirname "$0")/reports.sh"
command -v gpg >/dev/null || {
    echo 'gpg is not installed'
    exit 77
}
export GNUPGHOME=$folder/keys
export TMPDIR=$folder/temporary
mkdir -m 700 "$GNUPGHOME" "$TMPDIR"
trap 'gpgconf --kill all; rm -rf "$folder"' EXIT
gpg --batch --quiet --passphrase '' --quick-gen-key 'Tester <tester@example.org>' ed25519 sign never \
    2>"$folder/gpg" || { cat "$folder/gpg"; exit 1; }

# A campaign without recordings: a report that takes no time and has numbers all the same.
campaign() { # NUMBER MORE
    cat <<YAML
title: Nothing there
index: none.yaml
calibration_length_mm: 85
settings: {step_mm: 0.25}
wires: [{wire: type1}]
laboratory:
  report: $1
  issued: 2026-11-23
${2:-}
YAML
}
campaign WB-1 >"$folder/c.yaml"
cd "$folder" || exit 1

says() { grep -qF -e "$1" "$folder/out" "$folder/err" || fail "it does not say '$1': $(cat "$folder/err")"; }

# What cannot be signed is said before anything is written.
run 1 c.yaml -o r --sign nobody@example.org
says "gpg has no secret key 'nobody@example.org'"
sed '/^laboratory/,$d' c.yaml >plain.yaml
run 1 plain.yaml -o r --sign tester@example.org
says "has no 'laboratory'"
[ -e r ] && fail 'a report that cannot be signed was written'

run 3 c.yaml -o r --sign tester@example.org
says 'r/manifest.json.asc'
gpg --batch --quiet --verify r/manifest.json.asc r/manifest.json 2>/dev/null || fail 'gpg does not verify it'
python3 - <<'PYTHON' || fail 'the manifest is not that of the report'
import hashlib, json, os
manifest = json.load(open("r/manifest.json"))
def sum_of(path):
    return hashlib.sha256(open(path, "rb").read()).hexdigest()
assert manifest["report"] == "WB-1"
assert manifest["campaign"] == {"file": "c.yaml", "sha256": sum_of("c.yaml")}, manifest["campaign"]
listed = {f["name"]: f["sha256"] for f in manifest["files"]}
there = {os.path.relpath(os.path.join(d, f), "r") for d, _, fs in os.walk("r") for f in fs}
assert set(listed) == there - {"manifest.json", "manifest.json.asc"}, there
assert all(sum_of("r/" + name) == value for name, value in listed.items())
assert [i["name"] for i in manifest["inputs"]] == ["fixtures/wires/type1.yaml"], manifest["inputs"]
build = manifest["build"]
assert build["revision"] and build["compiler"] and build["processor"]
assert any(l["file"].startswith("libcairo.so.2") for l in build["libraries"])
assert [f["file"] for f in build["fonts"]] and "/" not in json.dumps(build["fonts"])
PYTHON
grep -qF "$folder" r/manifest.json && fail 'the manifest names a folder of this machine'

# A signed report stays, also with --force.
run 1 c.yaml -o r --force
says 'holds a signed report'

run 0 --check r
says 'signature: good, by Tester <tester@example.org>'
says 'inputs: 1 as signed'
says 'computed again: the same bytes'
[ -z "$(ls "$TMPDIR")" ] || fail 'the folder of the check is left'
run 0 --check r c.yaml
run 2 --check r -o x
run 1 --check .
says 'holds no signed report'

# Somewhere else, without the campaign, nothing is computed.
(cd / && run 3 --check "$folder/r" && says 'is not here, so nothing is computed again')
campaign WB-1 '  place: here' >other.yaml
run 1 --check r other.yaml
says 'is not the campaign that was signed'

# --- what is altered ---

altered() { # CODE WORDS COMMAND: of a copy; sums and signature stay as they were
    rm -rf a
    cp -r r a
    eval "$3"
    run "$1" --check a c.yaml
    says "$2"
}
altered 1 "'a/report.html' is not what was signed" 'echo >>a/report.html'
altered 1 "'a/report.pdf' is missing" 'rm a/report.pdf'
altered 1 'it was altered' 'sed -i s/WB-1/WB-2/ a/manifest.json'
altered 1 'no good signature' 'echo nonsense >a/manifest.json.asc'
altered 1 'the public key' 'rm -rf other; mkdir -m 700 other; GNUPGHOME=$folder/other gpg --batch --quiet \
    --passphrase "" --quick-gen-key "Other <other@example.org>" ed25519 sign never 2>/dev/null;
    GNUPGHOME=$folder/other gpg --batch --yes --quiet --armor --output a/manifest.json.asc --detach-sign a/manifest.json;
    GNUPGHOME=$folder/other gpgconf --kill all'

# Signed anew by someone who may: sums of files and build as given.
resigned() { # CODE WORDS PYTHON: changes `report`, `manifest` of a copy
    altered "$1" "$2" 'python3 - <<PYTHON
import hashlib, json
report, manifest = json.load(open("a/report.json")), json.load(open("a/manifest.json"))
'"$3"'
if report != json.load(open("a/report.json")):
    json.dump(report, open("a/report.json", "w"))
for f in manifest["files"]:
    f["sha256"] = hashlib.sha256(open("a/" + f["name"], "rb").read()).hexdigest()
json.dump(manifest, open("a/manifest.json", "w"))
PYTHON
    gpg --batch --yes --quiet --armor --output a/manifest.json.asc --detach-sign a/manifest.json'
}
resigned 1 "the same build makes another report: 'report.json'" 'report["settings"]["step_mm"] *= 1 + 1e-12'
resigned 0 'numbers within 1e-09; made by another build: compiler' \
    'report["settings"]["step_mm"] *= 1 + 1e-12; manifest["build"]["compiler"] = "another"'
resigned 0 'made by another build: options '"'-O0'" \
    'report["settings"]["step_mm"] *= 1 + 1e-12; manifest["build"]["options"] = "-O0"'
resigned 0 'made by another build: other libraries' \
    'report["tool"]["revision"] = "old"; manifest["build"]["libraries"][0]["sha256"] = "0"'
resigned 1 "not the same within 1e-09: 1 value of report.json, most 'settings.step_mm', 0.25 in it and 0.25 here, by 1e-08" \
    'report["settings"]["step_mm"] *= 1 + 1e-8; manifest["build"]["processor"] = "another"'
resigned 0 "numbers within 1e-09, but 1 of fits within 1e-05, most 'wires[0].outer_diameter_mm', by 1e-07 of it" \
    'report["wires"][0]["outer_diameter_mm"] *= 1 + 1e-7; manifest["build"]["processor"] = "another"'
resigned 1 "not the same within 1e-05: 1 value of report.json, most 'wires[0].outer_diameter_mm'" \
    'report["wires"][0]["outer_diameter_mm"] *= 1 + 1e-4; manifest["build"]["processor"] = "another"'
resigned 1 "not the same within 1e-05: 1 value of report.json, most 'wires[0].wire', 'another' in it" \
    'report["wires"][0]["wire"] = "another"; manifest["build"]["processor"] = "another"'
resigned 1 "input 'fixtures/wires/type1.yaml' is not what was signed" 'manifest["inputs"][0]["sha256"] = "0"'
resigned 1 'has no name' 'manifest["files"].append({"name": "../c.yaml", "sha256": "0"})' 2>/dev/null

# --- an amendment ---

campaign WB-1 '  amends: {report: WB-1, issued: 2026-11-23, why: a diameter}' >own.yaml
run 1 own.yaml -o amended --sign tester@example.org
says 'an amendment gets a new one'
campaign WB-2 '  amends: {report: WB-1, issued: 2026-11-23, why: a diameter}' >new.yaml
run 3 new.yaml -o amended --sign tester@example.org
grep -qF '"amends": "WB-1"' amended/manifest.json || fail 'the manifest does not say what is replaced'
grep -qF 'replaces report WB-1 of 2026-11-23' amended/report.html || fail 'the report does not say it'
run 0 --check amended
finish 'sign'
