# Sourced by the tests of shipped reports, with WIREBENCH and SOURCE_ROOT as arguments.
. "$(dirname "$0")/reports.sh"
root=$2

# Makes the report in $folder/a; $code is how that ended.
make_report() { # CAMPAIGN
    "$wirebench" report "$1" -o "$folder/a" >"$folder/a.out" 2>"$folder/a.err"
    code=$?
    cat "$folder/a.out"
}

# The same bytes from another folder, with another number of threads, in another time zone and
# language.
make_it_again() { # CAMPAIGN
    cd /tmp || exit 1
    TZ=Asia/Kathmandu LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 "$wirebench" report \
        "$1" -o "$folder/deeper/b" --threads 1 >/dev/null 2>&1
    [ $? -eq $code ] || fail 'another run ended otherwise'
    diff -r "$folder/a" "$folder/deeper/b" >/dev/null || fail 'another run gave other bytes'
}

expect_figures() { # NUMBER
    local found
    found=$(find "$folder/a/figures" -name '*.svg' | wc -l)
    [ "$found" -eq "$1" ] || fail "$found figures instead of $1"
}

forbid() { # EXTENDED REGULAR EXPRESSION: words and paths that must not be in the report
    grep -qiE "$1" "$folder/a/report.html" "$folder/a/report.json" &&
        fail 'a word or path that must not be there'
}
