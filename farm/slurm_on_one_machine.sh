#!/bin/sh
# Slurm with one node of eight slots on this machine, for tests: start FOLDER, or stop FOLDER. Needs Debian's slurm-wlm and munge, and root.
set -eu
action=$1 folder=$2
node=$(hostname -s)
export SLURM_CONF="$folder/slurm.conf"
case $action in
start)
    mkdir -p "$folder/state" "$folder/spool" /run/munge
    chown munge: /run/munge
    [ -s /etc/munge/munge.key ] || runuser -u munge -- mungekey --create 2>/dev/null || {
        dd if=/dev/urandom of=/etc/munge/munge.key bs=1024 count=1 2>/dev/null
        chown munge: /etc/munge/munge.key
        chmod 400 /etc/munge/munge.key
    }
    cat >"$SLURM_CONF" <<CONF
ClusterName=one
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=10
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
NodeName=$node NodeAddr=127.0.0.1 CPUs=8 State=UNKNOWN
PartitionName=all Nodes=$node Default=YES MaxTime=INFINITE State=UP
CONF
    runuser -u munge -- munged --foreground >"$folder/munged.log" 2>&1 &
    echo $! >"$folder/munged.pid"
    sleep 1
    slurmctld -D >/dev/null 2>&1 &
    slurmd -D >/dev/null 2>&1 &
    for _ in $(seq 60); do
        [ "$(sinfo --noheader --format %t 2>/dev/null)" = idle ] && exit 0
        sleep 1
    done
    echo "error: $folder: Slurm's node is not idle after a minute (look at slurmctld.log and slurmd.log there)" >&2
    exit 75
    ;;
stop)
    for name in slurmd slurmctld munged; do
        [ -s "$folder/$name.pid" ] && kill "$(cat "$folder/$name.pid")" 2>/dev/null || true
    done
    ;;
esac
