#!/bin/sh
# The dataset of a stored recording. Usage: align.sh WIREBENCH RECORDING STAMP
set -eu
"$1" align "$2" -o "${3%.done}" --force >/dev/null 2>&1 || [ $? = 3 ]
touch "$3"
