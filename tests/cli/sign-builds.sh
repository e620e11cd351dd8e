#!/bin/bash
# A report that arithmetic rounded in another way has made and signed passes `report --check`: the
# example of docs/signed-report and that of a harness, with OpenBLAS and the C library as on an old processor.
# Usage: sign-builds.sh WIREBENCH SOURCE_ROOT
. "$2/tests/cli/reports.sh"
command -v gpg >/dev/null || {
    echo 'gpg is not installed'
    exit 77
}
export GNUPGHOME=$folder/keys WIREBENCH_DATA=$2
mkdir -m 700 "$GNUPGHOME"
trap 'gpgconf --kill all; rm -rf "$folder"' EXIT
gpg --batch --quiet --passphrase '' --quick-gen-key 'Tester <tester@example.org>' ed25519 sign never \
    2>"$folder/gpg" || { cat "$folder/gpg"; exit 1; }
cp "$2/docs/signed-report/campaign.yaml" "$folder"
cd "$folder" || exit 1

export OPENBLAS_CORETYPE=Prescott GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2_Usable,-AVX2,-FMA_Usable,-FMA
run 0 campaign.yaml -o r --sign tester@example.org
cp "$2/fixtures/campaigns/harness.yaml" .
printf 'laboratory: {report: WB-2, issued: 2026-11-23}\n' >>harness.yaml
run 3 harness.yaml -o h --sign tester@example.org
unset OPENBLAS_CORETYPE GLIBC_TUNABLES

run 0 --check r
cat "$folder/out"
grep -qE 'computed again: numbers within 1e-09.*; made by another build: processor' "$folder/out" || {
    grep -q 'the same bytes' "$folder/out" && [ $failures -eq 0 ] && exit 77 # a processor without choice
    fail 'not seen as of another build'
}
# It would pass with ten times as much, too; fits whose beams are solved less tightly come to that.
largest=$(sed -n 's/.*, by \([-0-9.e]*\) of it;.*/\1/p' "$folder/out")
awk -v x="${largest:-0}" 'BEGIN { exit !(x + 0 <= 1e-6) }' || fail "fits differ by $largest"
# The equilibria of a harness come out alike.
run 0 --check h
grep -q 'computed again: numbers within 1e-09; made by another build: processor' "$folder/out" ||
    fail "a harness of another build: $(cat "$folder/out")"
# The example that is kept was made from the same files.
python3 - "$2/docs/signed-report/manifest.json" r/manifest.json <<'PYTHON' || fail 'the example was made of other inputs'
import json, sys
kept, now = (json.load(open(path)) for path in sys.argv[1:])
assert kept["campaign"] == now["campaign"] and kept["inputs"] == now["inputs"]
PYTHON
finish 'a signed report of another build'
