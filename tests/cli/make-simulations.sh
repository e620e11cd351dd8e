#!/bin/bash
# Which stored simulations simulations/make-simulations computes again, and which of them it replaces.
# Usage: make-simulations.sh WIREBENCH SOURCE_ROOT
. "$(dirname "$0")/shipped.sh"
tools=$root/simulations
cd "$folder" || exit 1

# A stored dataset and one that was computed later: other tables, revision and time.
later() { # SED COMMAND FOR A TABLE, TABLE, SED COMMANDS FOR dataset.json
    rm -rf stored new before
    mkdir stored new
    cp -r "$root/simulations/bundle-7-1d" stored/a
    cp -r stored/a before
    cp -r stored/a new/a
    sed -i "$1" "new/a/$2.csv"
    sed -i 's/"cpu_s": .*/"cpu_s": 1,/; s/"revision": .*/"revision": "later"/;'"${3:-}" new/a/dataset.json
    "$tools/take-datasets" new stored >said || fail "take-datasets ended with $?"
}
kept() { # WHAT
    diff -q before/force_deflection.csv stored/a && diff -q before/shape.csv stored/a &&
        grep -q 'a: confirmed' said && [ ! -e new/a ] || fail "$1 is replaced"
    diff before/dataset.json stored/a/dataset.json | grep '^>' | grep -vq "$2" &&
        fail "$1: dataset.json has more that is new"
    [ "$(grep -c '"confirmed_by_revision": "later"' stored/a/dataset.json)" -eq 1 ] || fail "$1 is not confirmed"
    "$wirebench" calibrate stored/a --method paper >/dev/null 2>&1 || fail "$1 cannot be read"
}
replaced() { # WHAT
    grep -q 'a: replaced' said && grep -q '"revision": "later"' stored/a/dataset.json || fail "$1 stays"
}

# The last row's force is 1.8 N, the largest.
later 's/,1.80018797[0-9]*,1.80018797[0-9]*,/,1.81,1.81,/' force_deflection
kept 'a force 0.5 % off' revision
cp -r before new/a
sed -i 's/"revision": .*/"revision": "latest"/' new/a/dataset.json
"$tools/take-datasets" new stored >said
[ "$(grep -c 'confirmed_by_revision": "latest"' stored/a/dataset.json)" -eq 1 ] &&
    ! grep -q '"later"' stored/a/dataset.json || fail 'an earlier confirmation stays'
later 's/,1.80018797[0-9]*,1.80018797[0-9]*,/,1.83,1.83,/' force_deflection
replaced 'a force 1.6 % off'
later 's/,1.80018797[0-9]*,1.80018797[0-9]*,/,nan,nan,/' force_deflection
replaced 'a force that is not a number'
later 's/^53,\(.*\),114,[0-9.]*,/53,\1,114,98.7,/' shape
replaced 'a place 0.4 mm off'
later '$d' shape
replaced 'a table with fewer rows'
later '1s/x_mm/u_mm/' shape
replaced 'a table with another column'
later '' shape 's/"yield_stress_MPa": .*/"yield_stress_MPa": 5,/'
replaced 'a dataset of other inputs'
later '' shape 's/"virtual_rig": false/"virtual_rig": true/'
replaced 'a dataset of another outcome'
later '' shape 's/^      "version": .*/      "version": 2,\n      "added": 3,/'
kept 'a dataset whose inputs know one more value' 'revision\|"version": 2\|"added": 3'
rm -r stored/a # its value is of a later version, so the check of all files would reject it
cp -r before new/b
"$tools/take-datasets" new stored | grep -q 'b: added' && [ -e stored/b/shape.csv ] || fail 'a new one is not added'

# The whole script: one is missing, two are outdated, of which one has other inputs.
mkdir shipped
for name in "$root"/simulations/{follower,residual}-*; do cp -r "$name" shipped; done
rm -r shipped/residual-2-8awg-1d
sed -i 's/^      "version": .*/      "version": 0,/' shipped/{follower,residual-1}-8awg-1d/dataset.json
sed -i 's/"strength_coefficient_MPa": 10.7/"strength_coefficient_MPa": 10.8/' shipped/residual-1-8awg-1d/dataset.json
WIREBENCH=$wirebench "$tools/make-simulations" shipped "$root/fixtures/campaigns/section2.yaml" >said 2>&1 ||
    fail "make-simulations ended with $?: $(cat said)"
grep -q '^follower-8awg-1d: confirmed' said || fail 'the same results are not confirmed'
grep -q '^residual-1-8awg-1d: replaced' said || fail 'other inputs are not replaced'
grep -q '^residual-2-8awg-1d: added' said || fail 'a missing one is not made'
[ "$(grep -cE '^[a-z0-9-]+: (added|confirmed|replaced)' said)" -eq 3 ] || fail 'others are computed again'
[ ! -e shipped.new ] || fail 'shipped.new stays'
diff "$root/simulations/index.yaml" shipped/index.yaml | grep -qE '^> .*(follower-8awg-3d|date)' &&
    fail 'the index changes for other datasets'

finish 'simulations are replaced when they differ'
