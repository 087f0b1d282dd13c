#!/bin/sh
# A job that answers SIGTERM with `scontrol requeue` of itself, as jobs do that save themselves before their time is over, cannot
# be cancelled: Slurm puts it back though scancel is what ended it. It is CG (completing), then waits ten seconds (BeginTime) and
# runs again; scontrol says JobState=RUNNING, Restarts=1. So who requeues himself asks first: squeue has CG for one that is being
# cancelled, R for one that is told that its time ends (--signal=B:TERM@60).
# Seen besides: `scancel` of a number that there never was says nothing and leaves with 0.
#   findings/slurm-requeue-undoes-scancel.sh     any user, with slurm-wlm and munge; a minute. 0: it is so; 1: it is not; 77: skipped
# With slurm-wlm 22.05.8-4+deb12u3 and munge 0.5.15-2+deb12u1, on amd64.
set -eu
PATH=$PATH:/usr/sbin
for program in munged slurmctld slurmd sbatch squeue scancel scontrol; do
    command -v $program >/dev/null || { echo "skipped: no $program here (Debian: slurm-wlm munge)"; exit 77; }
done
work=$(mktemp -d)
started=
trap 'scancel --quiet --me --full --signal=KILL || true; for pid in $started; do kill -9 "$pid" || true; done; sleep 1; rm -rf --one-file-system "$work"' EXIT
root=$(dirname "$0")/..
export SLURM_CONF="$work/slurm.conf"
sed -e "s|@HOST@|$(hostname -s)|; s|@USER@|$(id -un)|; s|@FOLDER@|$work|; s|@CONTROLLER_PORT@|16817|; s|@NODE_PORT@|16818|" \
    "$root/tests/data/one-node-slurm.conf" >"$SLURM_CONF"
mkdir "$work/state" "$work/spool"
(umask 277; head -c 128 /dev/urandom >"$work/munge.key")
begin() { "$@" >>"$work/said" 2>&1 & started="$started $!"; }
begin munged --foreground --force --key-file="$work/munge.key" --socket="$work/munge.socket" --pid-file="$work/munged.pid" --log-file="$work/munged.log" --seed-file="$work/seed"
sleep 2
begin slurmctld -D -f "$SLURM_CONF"
begin slurmd -D -f "$SLURM_CONF"
wait_for() { for _ in $(seq 300); do case $(eval "$1") in $2) return 0 ;; esac; sleep 0.2; done; cat "$work/said"; echo "not seen: $2"; exit 1; }
wait_for 'sinfo --noheader --format=%T 2>/dev/null' 'idle*'
cat >"$work/job.sh" <<'JOB'
#!/bin/sh
#SBATCH --requeue --output=/dev/null
trap 'scontrol requeue $SLURM_JOB_ID; sleep 60' TERM
sleep 600 & wait
JOB
number=$(sbatch --parsable "$work/job.sh")
wait_for "squeue --noheader --format=%t --jobs=$number" 'R'
sleep 1
scancel "$number"
for _ in $(seq 120); do
    state=$(squeue --noheader --format='%t %r' --jobs="$number")
    [ "$state" = "${before:-}" ] || echo "after scancel: ${state:-gone}"
    before=$state
    case $state in R*) break ;; esac
    sleep 0.2
done
scontrol show job "$number" | grep -o 'JobState=[A-Z]*\|Restarts=[0-9]*'
scancel 99999 && echo "scancel 99999, which there never was: exit code 0"
case $state in R*) echo "it runs again though it was cancelled"; exit 0 ;; esac
exit 1
