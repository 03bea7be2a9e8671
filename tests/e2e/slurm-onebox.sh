#!/usr/bin/env bash
# A real Slurm on this machine alone, for tests: no systemd, no cgroups, no munge, everything under one folder, on ports of its own.
# Needs root, as its nodes start jobs for others. Any user of this machine could use it, so it is for tests only.
#
#   slurm-onebox.sh FOLDER NODES -- COMMAND...    runs COMMAND with SLURM_CONF set, then stops all that it has started
#
# Each node pretends to have eight processors. FOLDER/ready appears when all nodes are there.
set -euo pipefail

folder=$(realpath -m "$1")
nodes=$2
shift 3
mkdir -p "$folder"/{run,state,log}
host=$(hostname)

# Ports that nobody listens on: one for the controller, one a node.
listening=$(awk 'NR > 1 { split($2, address, ":"); print address[2] }' /proc/net/tcp /proc/net/tcp6 2>/dev/null)
is_free() {
  local port
  for ((port = $1; port <= $1 + nodes; ++port)); do
    if grep -qix "$(printf '%04x' "$port")" <<<"$listening"; then
      return 1
    fi
  done
}
port=$((20000 + RANDOM % 8000))
until is_free "$port"; do
  port=$((20000 + RANDOM % 8000))
done

export SLURM_CONF=$folder/slurm.conf
{
  cat <<CONF
ClusterName=onebox
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
SlurmctldPort=$port
SlurmctldPidFile=$folder/run/slurmctld.pid
SlurmdPidFile=$folder/run/%n.pid
SlurmdSpoolDir=$folder/spool/%n
StateSaveLocation=$folder/state
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
MailProg=/bin/true
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
KillWait=2
CONF
  for ((node = 1; node <= nodes; ++node)); do
    mkdir -p "$folder/spool/n$node"
    echo "NodeName=n$node NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + node)) CPUs=8 State=UNKNOWN"
  done
  echo "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP"
} >"$SLURM_CONF"

# In the foreground, so that they are children of ours and no daemon stays.
slurmctld -D -c -f "$SLURM_CONF" >"$folder/log/slurmctld.out" 2>&1 &
started=($!)
for ((node = 1; node <= nodes; ++node)); do
  slurmd -D -f "$SLURM_CONF" -N "n$node" >"$folder/log/n$node.out" 2>&1 &
  started+=($!)
  echo $! >"$folder/run/n$node.started"
done
stop() {
  scancel -u root 2>/dev/null || true
  for ((attempt = 0; attempt < 50; ++attempt)); do
    [[ -n "$(squeue -h 2>/dev/null || true)" ]] || break
    sleep 0.1
  done
  kill "${started[@]}" 2>/dev/null || true
  # Looking for a node that is gone, the controller takes its time.
  for ((attempt = 0; attempt < 10; ++attempt)); do
    kill -0 "${started[@]}" 2>/dev/null || break
    sleep 0.1
  done
  kill -KILL "${started[@]}" 2>/dev/null || true
  wait "${started[@]}" 2>/dev/null || true
}
trap stop EXIT

for ((attempt = 0; attempt < 300; ++attempt)); do
  if [[ "$(sinfo -h -t idle -o %D 2>/dev/null || true)" == "$nodes" ]]; then
    touch "$folder/ready"
    "$@"
    exit
  fi
  sleep 0.1
done
echo "slurm-onebox.sh: Slurm does not come up; see $folder/log" >&2
exit 1
