#!/bin/sh
# Runs a program on MPI ranks of this machine: ranks.sh RANKS PROGRAM ARGUMENT...
# Exits with 77 (skipped) without mpirun.
set -eu
command -v mpirun >/dev/null || {
    echo "skipped: no mpirun (Debian: openmpi-bin)"
    exit 77
}
# Containers run as root and have fewer cores than ranks.
OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
OMPI_MCA_btl_vader_single_copy_mechanism=none
export OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM OMPI_MCA_btl_vader_single_copy_mechanism
# The MPI libraries leak memory; all other errors of AddressSanitizer still end the program.
ASAN_OPTIONS="${ASAN_OPTIONS:-}${ASAN_OPTIONS:+:}detect_leaks=0"
export ASAN_OPTIONS
ranks=$1
shift
exec mpirun --oversubscribe -n "$ranks" "$@"
