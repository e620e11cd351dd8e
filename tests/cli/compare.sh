#!/bin/bash
# `wirebench compare` as a user meets it: verdicts as exit codes, the page, what it refuses.
# Usage: compare.sh WIREBENCH SOURCE_ROOT
. "$(dirname "$0")/reports.sh"
card=$(realpath "$2")/docs/cards/type1.yaml

compare() { # EXPECTED ARGUMENTS...
    local expected=$1 code
    shift
    "$wirebench" compare "$@" >"$folder/out" 2>"$folder/err"
    code=$?
    [ $code -eq "$expected" ] || {
        fail "compare $*: exit code $code, expected $expected"
        cat "$folder/out" "$folder/err"
    }
}

# All numbers of the batch B that carry a moment are a factor higher.
mkdir "$folder/other"
sed -n '/^moment_curvature:/,/^[a-z_]*stiffness/p' "$card" | grep -q moment_N_mm || fail 'no moments in the card'
python3 - "$card" "$folder/other/type1.yaml" <<'PYTHON'
import re, sys
text = open(sys.argv[1]).read()
scale = lambda m: m[1] + repr(1.6 * float(m[2]))
numbers = r"((?:moment_N_mm|low|high|candidates_low|candidates_high): )([-+.e0-9]+)"
moments = re.compile(r"^  - \{curvature_1_m: .*$", re.M)
open(sys.argv[2], "w").write(moments.sub(lambda line: re.sub(numbers, scale, line[0]), text))
PYTHON
cmp -s "$card" "$folder/other/type1.yaml" && fail 'the other batch is the same'

compare 2 "$card"
compare 2 "$card" "$card"
grep -q -- '--within' "$folder/err" || fail 'the limit that is missing is not named'
compare 2 "$card" "$card" "$card" --within 0.1
compare 2 "$card" "$card" --within 0
compare 2 "$card" "$card" --within much
compare 1 "$card" "$folder/none.yaml" --within 0.1

compare 0 "$card" "$card" --within 1
grep -q '^found .*equivalent: all 8 quantities; farthest: .* B/A ' "$folder/out" || fail 'no verdict on all'
compare 3 "$card" "$card" --within 0.03
grep -q 'cannot tell: test [0-9]* more specimens of each' "$folder/out" || fail 'no number of specimens'
compare 4 "$card" "$folder/other/type1.yaml" --within 0.01
grep -q '^M at .* B/A 1.6.*different$' "$folder/out" || fail 'the moments are not different'
grep -q '^found .*different: at least one of 8' "$folder/out" || fail 'no verdict on all'

# One page, which says where the data come from, and the same bytes again.
compare 0 "$card" "$card" --within 1 -o "$folder/page.pdf"
compare 1 "$card" "$card" --within 1 -o "$folder/page.pdf"
grep -q -- '--force' "$folder/err" || fail 'the message does not name --force'
cp "$folder/page.pdf" "$folder/before.pdf"
compare 0 "$card" "$card" --within 1 -o "$folder/page.pdf" --force
cmp -s "$folder/page.pdf" "$folder/before.pdf" || fail 'the same files gave other bytes'
if command -v pdftotext >/dev/null; then
    compare 4 "$card" "$folder/other/type1.yaml" --within 0.01 -o "$folder/two.pdf"
    pdftotext -layout "$folder/two.pdf" "$folder/two.txt"
    for words in 'Virtual rig' 'Page 1 of 1' 'Verdict: different' 'B: other/type1.yaml' \
        '8 quantities' "$(sha256sum "$card" | cut -c1-64)"; do
        grep -qF -e "$words" "$folder/two.txt" || fail "the page does not say '$words'"
    done
fi

compare 0 "$card" "$card" --within 1 --json
python3 - "$folder/out" <<'PYTHON' || fail 'the JSON is not what was computed'
import json, sys
root = json.load(open(sys.argv[1]))
assert root["verdict"] == "equivalent" and root["alpha"] == 0.05, root
assert root["quantities_compared"] == 8 == len(root["quantities"])
for q in root["quantities"]:
    assert abs(q["log_ratio"]) < 1e-12 and q["A"]["n"] == 3
    assert abs(q["log_ratio_low"] + q["log_ratio_high"]) < 1e-12 and q["log_ratio_high"] > 0
PYTHON
finish 'compare'
