#!/usr/bin/env bash
# A Slurm of one node on this machine, for tests: no systemd, no cgroups, no accounting database.
#   cluster.sh up | env | down      (needs Debian's slurmctld slurmd slurm-client munge; state under $SLURM_SANDBOX)
set -euo pipefail
ROOT=${SLURM_SANDBOX:?folder for the state}
HOST=$(hostname -s)
export SLURM_CONF=$ROOT/etc/slurm.conf
SOCKET=$ROOT/run/munge.sock

# a zombie that nobody has reaped yet does not run, though kill -0 finds it
runs() { local s; s=$(sed 's/.*) //' "/proc/$1/stat" 2>/dev/null) && [[ -n $s && ${s:0:1} != Z ]]; }
alive() { [[ -s $1 ]] && runs "$(cat "$1")"; }
wait_for() { local n=$1; shift; for ((i = 0; i < n * 10; i++)); do "$@" >/dev/null 2>&1 && return 0; sleep 0.1; done
  echo "timeout: $*" >&2; return 1; }
ready() { timeout 5 sinfo -h -o %T | grep -Eq 'idle|mixed|allocated'; }

write_conf() {
  mkdir -p "$ROOT"/{etc,run,log,state,spool,munge,bin}
  chmod 755 "$ROOT" "$ROOT"/{etc,run,state,spool,log}; chmod 700 "$ROOT/munge"
  [[ -s $ROOT/munge/munge.key ]] || dd if=/dev/urandom of="$ROOT/munge/munge.key" bs=128 count=1 status=none
  chmod 600 "$ROOT/munge/munge.key"
  : > "$ROOT/etc/plugstack.conf"
  # the executor's job step drops SLURM_CONF before its inner srun: this one, early on PATH, puts it back
  printf '#!/bin/sh\nexport SLURM_CONF=%s\nexec /usr/bin/srun "$@"\n' "$SLURM_CONF" > "$ROOT/bin/srun"
  chmod 755 "$ROOT/bin/srun"
  local memory=$(($(awk '/MemTotal/{print $2}' /proc/meminfo) / 1024 - 1024))
  cat > "$SLURM_CONF" <<C
ClusterName=trackroller
SlurmctldHost=$HOST(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$SOCKET
CredType=cred/munge
SlurmctldPort=16827
SlurmdPort=16828
SlurmctldPidFile=$ROOT/run/slurmctld.pid
SlurmdPidFile=$ROOT/run/slurmd.pid
SlurmctldLogFile=$ROOT/log/slurmctld.log
SlurmdLogFile=$ROOT/log/slurmd.log
StateSaveLocation=$ROOT/state
SlurmdSpoolDir=$ROOT/spool
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=5
ReturnToService=2
SwitchType=switch/none
KillWait=5
InactiveLimit=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
PropagateResourceLimits=NONE
PlugStackConfig=$ROOT/etc/plugstack.conf
MailProg=/bin/true
NodeName=$HOST NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory State=UNKNOWN
PartitionName=main Nodes=$HOST Default=YES MaxTime=INFINITE State=UP
C
}

up() {
  write_conf
  alive "$ROOT/run/munged.pid" || munged --force --num-threads=2 --socket="$SOCKET" --key-file="$ROOT/munge/munge.key" \
    --pid-file="$ROOT/run/munged.pid" --log-file="$ROOT/log/munged.log" --seed-file="$ROOT/munge/seed"
  wait_for 10 munge -n -S "$SOCKET"
  alive "$ROOT/run/slurmctld.pid" || slurmctld -i
  wait_for 20 scontrol ping
  alive "$ROOT/run/slurmd.pid" || slurmd
  wait_for 20 ready
}

stop() { # pid file, seconds of grace
  [[ -s $1 ]] || return 0
  local pid; pid=$(cat "$1")
  kill -TERM "$pid" 2>/dev/null || { rm -f "$1"; return 0; }
  for ((i = 0; i < $2 * 10; i++)); do runs "$pid" || { rm -f "$1"; return 0; }; sleep 0.1; done
  kill -KILL "$pid" 2>/dev/null || true
  rm -f "$1"
}

down() {
  if alive "$ROOT/run/slurmctld.pid"; then
    timeout 5 scancel -u "$(id -un)" 2>/dev/null || true
    wait_for 15 bash -c '[[ -z $(squeue -h) ]]' || true
  fi
  stop "$ROOT/run/slurmd.pid" 10
  stop "$ROOT/run/slurmctld.pid" 15
  stop "$ROOT/run/munged.pid" 5
}

case "${1:-}" in
  up) up ;;
  down) down ;;
  env) echo "$SLURM_CONF $ROOT/bin" ;;
  *) echo "usage: cluster.sh up|env|down" >&2; exit 2 ;;
esac
