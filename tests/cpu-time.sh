#!/bin/bash
# Runs a test and appends its CPU seconds and its command to the file $WIREBENCH_CPU_TIMES. For
# `meson test --wrapper`.
TIMEFORMAT='%U %S'
{ time "$@" 2>&3; } 3>&2 2>"${WIREBENCH_CPU_TIMES:?}.$$"
code=$?
echo "$(cat "$WIREBENCH_CPU_TIMES.$$") $*" >>"$WIREBENCH_CPU_TIMES"
rm -f "$WIREBENCH_CPU_TIMES.$$"
exit $code
