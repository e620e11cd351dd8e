#!/bin/sh
# Results of the tool for a stored recording, once for all tests that need them: dataset, and
# properties by both methods. Usage: prepare.sh WIREBENCH RECORDING STAMP
set -eu
tool=$(realpath "$1") recording=$(realpath "$2") stamp=$(realpath -m "$3")
mkdir -p "${stamp%.done}"
cd "${stamp%.done}"
"$tool" align "$recording" -o dataset --force >/dev/null 2>&1 || [ $? = 3 ]
"$tool" calibrate dataset -o cycle.yaml --no-figure --force --json >cycle.json 2>/dev/null
"$tool" calibrate dataset --method paper -o paper.yaml --force >/dev/null 2>&1
touch "$stamp"
