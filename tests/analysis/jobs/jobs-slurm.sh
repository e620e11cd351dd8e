#!/bin/bash
# `wirebench report --slurm` in a real Slurm of one node, which this test starts itself: munged with
# its own key, slurmctld and slurmd, on free ports, with all their files in a temporary folder. It
# needs root (for slurmd) and the programs; without them it is skipped and prints the reason. In a
# PID namespace, if permitted, the kernel ends all processes with this script.
# Usage: jobs-slurm.sh WIREBENCH
PATH=$PATH:/usr/sbin:/sbin
[ "$(id -u)" -eq 0 ] || { echo 'skipped: slurmd needs root'; exit 77; }
for program in munged slurmctld slurmd sbatch squeue scancel sinfo scontrol; do
    command -v $program >/dev/null || { echo "skipped: there is no $program"; exit 77; }
done
if [ $# -eq 1 ] && unshare --pid --fork --mount-proc true 2>/dev/null; then
    exec unshare --pid --fork --mount-proc --kill-child "$0" "$1" inside
fi
. "$(dirname "$0")/../../cli/reports.sh"
chmod 755 "$folder"
mkdir -p "$folder"/{munge,state,spool} "$folder/9% of it's work/sim"
trap 'kill $(jobs -p) 2>/dev/null; wait; rm -rf "$folder"' EXIT
export SLURM_CONF=$folder/slurm.conf

free_port() {
    local port
    while port=$((20000 + RANDOM)) && (: <"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do :; done
    echo $port
}
soon() { # SHELL COMMAND: within 40 s it succeeds
    for ((i = 0; i < 200; i++)); do
        eval "$1" >/dev/null 2>&1 && return
        sleep 0.2
    done
    return 1
}

# --- the cluster: two cores, whatever the machine has ---

(umask 077; head -c 128 /dev/urandom >"$folder/munge/key")
cat >"$SLURM_CONF" <<CONF
ClusterName=wirebench
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
MailProg=/bin/true
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
KillWait=2
ReturnToService=2
SlurmdParameters=config_overrides
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
# Cgroups are not used, but the plugin is loaded.
version=v1
[ -e /sys/fs/cgroup/cgroup.controllers ] && version=v2
printf '%s\n' CgroupPlugin=cgroup/$version CgroupAutomount=no IgnoreSystemd=yes >"$folder/cgroup.conf"
munged --foreground --force --socket="$folder/munge/socket" --key-file="$folder/munge/key" \
    --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" \
    >"$folder/munged.out" 2>&1 &
soon '[ -e "$folder/munge/socket" ]'
slurmctld -D -c -i >"$folder/slurmctld.out" 2>&1 &
slurmd -D >"$folder/slurmd.out" 2>&1 &
soon 'sinfo --noheader --format=%T | grep -qx idle' || {
    echo 'FAILED: Slurm did not start'
    tail -n 15 "$folder"/*.out
    exit 1
}

# --- a campaign of one wire, solved in a second, and of one that takes minutes ---

cd "$folder/9% of it's work" || exit 1
cat >one.yaml <<'YAML'
name: one
title: One wire
wires: [{wire: type3, count: 1}]
packing: hexagon
length_mm: 85
interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}
meshes: [{name: coarse, core_quads: 2, rings: 1, elements_along: 20, formulation: 2x2x1}]
run: {mesh: coarse, deflection_mm: 10, rows: 20, mass_scaling: 25, selective_mass_scaling: 10}
loads: {strand_mm: 760, weight: true}
published: {outer_diameter_mm: 1.4, density_g_cm3: 4.97, beam: type3}
YAML
cat >c.yaml <<'YAML'
kind: bundles
title: One wire
simulations: sim
defaults: {dead_force: true, weight: false, duration_s: 1.5}
runs:
  - {name: one, bundle: ./one.yaml}
  - {name: one-0.2, bundle: ./one.yaml, friction: 0.2}
  - {name: slow, bundle: ./one.yaml, friction: 0.3, duration_s: 3000}
groups:
  - label: A wire
    bundles: [{label: one wire, dynamic: one, constant: one-0.2, rod: one-1d}]
fit: {elements: 10, fibres: 12}
YAML
report() { # EXIT CODE OPTIONS...
    run "$1" c.yaml -o r --force --slurm --slurm-partition=main "${@:2}"
}
assert_contains() { # FILE TEXT
    grep -qF -- "$2" "$folder/$1" || fail "missing: $2; but: $(cat "$folder/$1")"
}
task() { # NAME: as Slurm calls it
    sed -n '1s/^\([0-9]*\) \([0-9]*\) .*/\1_\2/p' "r.jobs/$1.slurm"
}
is_running() { [ "$(squeue -h -r -j "$(task "$1")" -o %T)" = RUNNING ]; }

# One task is cancelled before it starts, one while it runs, one cannot write its log, one succeeds.
mkdir -p r.jobs/one.log
{
    soon '[ -e r.jobs/one.slurm -a -e r.jobs/one-0.2.slurm -a -e r.jobs/one-1d.slurm -a -e r.jobs/slow.slurm ]'
    soon 'grep -q JobHeld "$folder/err"'
    scancel "$(task one-0.2)"
    scontrol release "$(task slow | sed 's/_.*//')"
    soon 'is_running slow' && scancel "$(task slow)"
} >/dev/null 2>&1 &
report 3 --slurm-option=--hold --slurm-time=10 --slurm-memory=100M
assert_contains err "tasks wait in Slurm's queue: JobHeld"
grep -q "run 'one-0.2' failed: Slurm's task [0-9_]* is gone and has no output" "$folder/err" ||
    fail 'a task that was cancelled before it began is not named'
grep -q "run 'slow' failed: Slurm's task [0-9_]* is CANCELLED" "$folder/err" || fail 'a cancelled task is not named'
assert_contains err 'CANCELLED AT ' # Slurm's own words
grep -q "run 'one' failed: Slurm's task [0-9_]* is FAILED" "$folder/err" || fail 'a failed task is not named'
assert_contains out '1 of 4 datasets used'
[ -e r/report.pdf ] && [ -e sim/one-1d/dataset.json ] && [ ! -e sim/slow ] || fail 'the first array'

# An interrupted call leaves its array to the next call, which submits nothing.
rmdir r.jobs/one.log
"$wirebench" report c.yaml -o r --force --slurm --slurm-option=--hold 2>"$folder/err" >/dev/null &
waiting=$!
soon '[ -e r.jobs/one.slurm -a -e r.jobs/one-0.2.slurm -a -e r.jobs/slow.slurm ]' || fail 'nothing is submitted again'
kill -TERM $waiting
wait $waiting
assert_contains err 'Slurm continues 3 of the runs'
{
    soon 'grep -q "in Slurm.s queue from an earlier call" "$folder/err"'
    scontrol release "$(task slow | sed 's/_.*//')"
    soon 'is_running slow' && scancel "$(task slow)"
} >/dev/null 2>&1 &
report 3
assert_contains err '3 runs are still in Slurm'
assert_contains out '3 of 4 datasets used'
[ "$(wc -l <sim/one/force_deflection.csv)" -eq 22 ] || fail 'a dataset of 21 rows is not whole'
[ "$(wc -l <r.jobs/slurm-2/jobs.txt)" -eq 3 ] && [ ! -e r.jobs/slurm-3 ] || fail 'runs are submitted twice'

# An error of Slurm, and a call that needs no Slurm.
run 1 c.yaml -o r --force --slurm --slurm-partition=nowhere
assert_contains err 'sbatch rejected the array'
assert_contains err artition
sed -i '/name: slow/d' c.yaml
report 0
assert_contains out '3 of 3 datasets used'
ls r.jobs/*.slurm sim/*.partial 2>/dev/null && fail 'something is left'

# The runs of a harness's bands as an array.
cat >h.yaml <<YAML
kind: harness
name: h
wires: [{name: lead, wire: $(cd "$(dirname "$0")/../../.." && pwd)/docs/cards/type1.yaml}]
root: {name: R}
branches: [{name: B, from: R, to: K, wire: lead, length_mm: 90}]
steps: [hang]
YAML
"$wirebench" solve harness h.yaml --uncertain --runs 40 -o h >/dev/null 2>"$folder/err" || fail "$(cat "$folder/err")"
"$wirebench" solve harness h.yaml --uncertain --runs 40 --slurm -o array >/dev/null 2>"$folder/err" ||
    fail "the bands by Slurm: $(cat "$folder/err")"
cmp -s h/harness.json array/harness.json || fail 'the bands by Slurm differ'
[ "$(wc -l <array.jobs/slurm-1/jobs.txt)" -eq 2 ] || fail 'the runs are not two tasks'

finish 'jobs of a real Slurm'
