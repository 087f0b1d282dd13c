#!/bin/sh
# A job that answers SIGTERM with `scontrol requeue` of itself, as jobs do that save themselves before their time is over, cannot
# be cancelled: Slurm puts it back though scancel is what ended it. It is CG (completing), then waits (BeginTime) for a second more
# than cred_expire, 121 by default and 6 here, and runs again; scontrol says JobState=RUNNING, Restarts=1. So who requeues himself
# asks first: squeue has CG for one that is being cancelled, R for one that is told that its time ends (--signal=B:TERM@60).
# Seen besides: `scancel` of a number that there never was says nothing and leaves with 0.
#   findings/slurm-requeue-undoes-scancel.sh     as root, with mmdebstrap; minutes, 80 MB. 0: it is so; 1: it is not; 77: skipped
# With slurm-wlm 22.05.8-4+deb12u3 and munge 0.5.15-2+deb12u1, on amd64.
set -eu
if [ "$(id -u)" != 0 ] || ! unshare -p -f --mount-proc true; then echo "skipped: this wants root and namespaces of its own"; exit 77; fi
work=$(mktemp -d)
inside=
trap 'kill -9 $inside 2>/dev/null && sleep 1; rm -rf --one-file-system "$work"' EXIT
trap 'exit 1' HUP INT TERM
slurm=22.05.8-4+deb12u3
mmdebstrap --quiet --variant=extract --include=slurm-wlm=$slurm,slurmctld=$slurm,slurmd=$slurm,slurm-client=$slurm \
    --include=slurm-wlm-basic-plugins=$slurm,munge=0.5.15-2+deb12u1,dash,coreutils,grep bookworm "$work/root" \
    http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
cd "$work/root"
mkdir -p proc run/munge var/spool/slurmd var/spool/slurmctld
for program in slurmctld slurmd slurmstepd; do ln -s $program-wlm usr/sbin/$program; done
echo 'root:x:0:0::/:/bin/sh' >etc/passwd
echo 'root:x:0:' >etc/group
(umask 277; head -c 128 /dev/urandom >etc/munge/munge.key)
echo CgroupPlugin=cgroup/v1 >etc/slurm/cgroup.conf # is not used; without it slurmd looks for the kind in /sys and ends
cat >etc/slurm/slurm.conf <<END
ClusterName=finding
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=root
SlurmctldPort=26817
SlurmdPort=26818
AuthInfo=cred_expire=5
StateSaveLocation=/var/spool/slurmctld
ProctrackType=proctrack/linuxproc
KillWait=2
SchedulerParameters=sched_interval=1
NodeName=$(hostname -s) NodeAddr=127.0.0.1
PartitionName=main Nodes=ALL Default=YES
END
cat >job.sh <<'END'
#!/bin/sh
#SBATCH --requeue --output=/dev/null
trap 'scontrol requeue $SLURM_JOB_ID; sleep 60' TERM
sleep 600 & wait
END
cat >cancel.sh <<'END'
for daemon in 'munged --foreground' 'slurmctld -D' 'slurmd -D'; do $daemon >>said 2>&1 & sleep 2; done
wait_for() { for _ in $(seq 300); do case $(eval "$1") in $2) return 0 ;; esac; sleep 0.2; done; cat said; echo "not seen: $2"; exit 1; }
wait_for 'sinfo --noheader --format=%T 2>/dev/null' 'idle*'
number=$(sbatch --parsable job.sh)
wait_for "squeue --noheader --format=%t --jobs=$number" R
sleep 1
scancel "$number"
for _ in $(seq 300); do
    state=$(squeue --noheader --format='%t %r' --jobs="$number")
    [ "$state" = "$before" ] || echo "after scancel: ${state:-gone}"
    before=$state
    case $state in R*) break ;; esac
    sleep 0.2
done
scontrol show job "$number" | grep -o 'JobState=[A-Z]*\|Restarts=[0-9]*'
said=$(scancel 99999 2>&1)
echo "scancel 99999: '$said', exit code $?"
END
# What is mounted and started there is this command's alone, and ends with it.
env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin unshare -m -p -f --kill-child sh -c \
    'mount -t proc proc proc && mount --rbind /dev dev && exec chroot . sh cancel.sh' >"$work/seen" 2>&1 &
inside=$!
wait $inside || { inside=; cat "$work/seen"; exit 1; }
inside=
cat "$work/seen"
cat >"$work/wanted" <<'END'
after scancel: CG None
after scancel: PD BeginTime
after scancel: R None
JobState=RUNNING
Restarts=1
scancel 99999: '', exit code 0
END
! grep -vxFf "$work/seen" "$work/wanted" || { echo "the lines above were not seen: Slurm does otherwise than it did"; exit 1; }
