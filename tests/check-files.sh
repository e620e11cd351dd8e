#!/bin/sh
# Files with a key that has no row, without a required key, or with a value of another type do not
# pass tests/check-files.py. Usage: check-files.sh PYTHON CHECK-FILES SCHEMAS PREPARED_FOLDER
set -eu
python=$1 check=$2 schemas=$3 prepared=$4
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
    echo "$*"
    exit 1
}
rejected() { # FILE PLACE: the check names the place
    ! "$python" "$check" "$schemas" "$folder/$1" >"$folder/out" ||
        fail "$1 is accepted: $2"
    grep -qF "$folder/$1: $2" "$folder/out" || fail "'$2' is not named: $(cat "$folder/out")"
}
change() { # FILE STATEMENT: on the content d of the prepared dataset
    "$python" -c "import json, sys
d = json.load(open(sys.argv[1], encoding='utf-8'))
$2
json.dump(d, open(sys.argv[2], 'w', encoding='utf-8'))" "$prepared/dataset/dataset.json" "$folder/$1"
}
mkdir "$folder/a"
change a/dataset.json 'pass'
"$python" "$check" "$schemas" "$folder/a" || fail 'the unchanged file is rejected'
change a/dataset.json 'd["test"]["undocumented_mm"] = 1'
rejected a/dataset.json 'test: '
grep -qF undocumented_mm "$folder/out"
change a/dataset.json 'del d["test"]["wire"]'
rejected a/dataset.json "test: 'wire' is a required property"
change a/dataset.json 'd["checks"]["rows"]["gaps"] = "none"'
rejected a/dataset.json 'checks.rows.gaps: '
change a/dataset.json 'd["test"]["loading"] = "sideways"'
rejected a/dataset.json 'test.loading: '
sed 's/^wire:.*/&\nundocumented: 1/' "$prepared/cycle.yaml" >"$folder/p.yaml"
rejected p.yaml 'the root: '
sed '/^poissons_ratio:/d' "$prepared/cycle.yaml" >"$folder/p.yaml"
rejected p.yaml "the root: 'poissons_ratio' is a required property"
mkdir "$folder/empty"
! "$python" "$check" "$schemas" "$folder/empty" >/dev/null || fail 'a folder without a file is accepted'
