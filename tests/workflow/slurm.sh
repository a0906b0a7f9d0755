#!/bin/bash
# Runs a small study through Snakemake on a Slurm of this machine alone, and compares its tables with
# those of one go. Usage: slurm.sh PROGRAM. Exit code 77: something that it needs is not there.
# Packages: snakemake slurm-wlm munge. The daemons need root; they are gone at the end.
set -euo pipefail
program=$(realpath "$1")
PATH=$PATH:/usr/sbin
for needed in snakemake sbatch slurmctld slurmd munged; do
  command -v $needed > /dev/null || { echo "skipped: there is no $needed"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "skipped: the daemons of Slurm need root"; exit 77; }

folder=$(mktemp -d)
host=$(hostname -s)
finish() {
  for daemon in slurmd slurmctld munged; do
    [ -f "$folder/$daemon.pid" ] && kill "$(cat "$folder/$daemon.pid")"
  done
  sleep 1
  rm -rf "$folder"
}
trap finish EXIT
cd "$folder"
mkdir state spool

head -c 1024 /dev/urandom > key
chmod 400 key
munged --force --socket="$folder/munge" --key-file=key --pid-file="$folder/munged.pid" \
  --log-file="$folder/munged.log" --seed-file="$folder/seed"

export SLURM_CONF=$folder/slurm.conf
cat > slurm.conf << END
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$folder/munge
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
END
slurmctld
slurmd -N "$host"
for _ in $(seq 30); do
  sinfo -h -o %t | grep -qx idle && break
  sleep 1
done

cat > scene.json << 'END'
{ "name": "fall", "materials": { "rock": { "density": 2000 } }, "gravity": [0, -10],
  "bodies": [ { "name": "stone", "material": "rock", "polygon": [[0,0],[1,0],[1,1],[0,1]] } ],
  "time": { "end": 0.1, "step": 1e-3 },
  "expect": [ { "quantity": "stone.vy", "take": "last", "value": 0, "tolerance": 100 } ] }
END
sweep=("$program" sweep scene.json --vary gravity.1=-1..-4:-1 --vary bodies.stone.spin=0,1)
"${sweep[@]}" -o whole --quiet
"${sweep[@]}" -o study --workflow snakemake --shards 3
snakemake -j4 -s study/Snakefile \
  --cluster "sbatch --parsable --cpus-per-task={threads} --output=$folder/job-%j.txt"

[ "$(grep -c 'job_complete: JobId=.* done' slurmctld.log)" = 4 ] # three parts and the tables
cmp whole/summary.csv study/summary.csv
# The wall time stands behind seven commas: the name of a run has one of its own.
cmp <(cut -d, -f1-7,9- whole/runs.csv) <(cut -d, -f1-7,9- study/runs.csv)
echo "eight runs in three jobs of Slurm, and the tables in a fourth: the same as in one go"
