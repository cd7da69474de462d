# A private Slurm cluster on the loopback interface: two emulated nodes of one real machine. To be sourced.
#   cluster_start FOLDER   starts munged, slurmctld and two slurmd; exports SLURM_CONF
#   cluster_stop           cancels the jobs, ends exactly these daemons and removes FOLDER
# Needs root: munged and slurmctld run as their own users, slurmd starts steps as the submitting user.

cluster_root=''
cluster_nodes=2
cluster_cpus=2

cluster_fail() {
  echo "Slurm cluster cannot be started at ${cluster_root:-?} ($*): see the logs above" >&2
  tail -n 20 "$cluster_root"/log/* >&2 2>/dev/null
  return 1
}

# cluster_retry SECONDS COMMAND...: repeats the command until it succeeds, for at most SECONDS
cluster_retry() {
  local tenths=$(($1 * 10)) i
  shift
  for ((i = 0; i < tenths; i++)); do
    "$@" >/dev/null 2>&1 && return 0
    sleep 0.1
  done
  return 1
}

cluster_folders() {
  install -d -m 755 "$cluster_root" "$cluster_root"/{etc,log,spool,pmix}
  install -d -m 755 -o slurm -g slurm "$cluster_root"/{state,run}
  install -d -m 700 -o munge -g munge "$cluster_root/key"
  install -d -m 755 -o munge -g munge "$cluster_root/munge"
  chmod 777 "$cluster_root/log" # three daemons under three users write here
}

cluster_munge() {
  # With a separate key and socket, a munged of the machine is neither needed nor disturbed.
  (umask 077 && head -c 64 /dev/urandom >"$cluster_root/key/munge.key")
  chown munge:munge "$cluster_root/key/munge.key"
  setpriv --reuid=munge --regid=munge --clear-groups munged --force \
    --socket="$cluster_root/munge/socket" --pid-file="$cluster_root/munge/munged.pid" \
    --key-file="$cluster_root/key/munge.key" --seed-file="$cluster_root/key/seed" \
    --log-file="$cluster_root/key/munged.log"
  cluster_retry 5 munge -n -S "$cluster_root/munge/socket" || cluster_fail "munged does not answer"
}

cluster_configure() {
  local first_port=$((20000 + $$ % 10000)) n
  {
    cat <<CONF
ClusterName=swingbank
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$first_port
SlurmUser=slurm
AuthType=auth/munge
# A requeued job may start again only after cred_expire seconds (default 120).
AuthInfo=socket=$cluster_root/munge/socket,cred_expire=5
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
# For containers: no cgroups, and the number of cores from the node lines below instead of the machine.
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SlurmdParameters=config_overrides
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobRequeue=1
ReturnToService=2
KillWait=5
MinJobAge=3600
SchedulerParameters=batch_sched_delay=0,sched_interval=2,sched_min_interval=0,bf_interval=2
StateSaveLocation=$cluster_root/state
SlurmdSpoolDir=$cluster_root/spool/%n
SlurmctldPidFile=$cluster_root/run/slurmctld.pid
SlurmdPidFile=$cluster_root/run/%n.pid
SlurmctldLogFile=$cluster_root/log/slurmctld.log
SlurmdLogFile=$cluster_root/log/%n.log
CONF
    local megabytes
    megabytes=$(awk '/^MemTotal:/ {print int($2 / 1024)}' /proc/meminfo)
    for ((n = 1; n <= cluster_nodes; n++)); do
      echo "NodeName=node$n NodeHostname=node$n NodeAddr=127.0.0.1 Port=$((first_port + n)) CPUs=$cluster_cpus RealMemory=$((megabytes * 9 / 10)) State=UNKNOWN"
    done
    echo "PartitionName=main Nodes=ALL Default=YES State=UP MaxTime=60 DefaultTime=10"
  } >"$cluster_root/etc/slurm.conf"
  echo "PMIxCliTmpDirBase=$cluster_root/pmix" >"$cluster_root/etc/mpi.conf"
  {
    cat /etc/hosts
    for ((n = 1; n <= cluster_nodes; n++)); do echo "127.0.0.1 node$n"; done
  } >"$cluster_root/etc/hosts"
}

# Each slurmd has its own host name, and its own folder mounted at the common PMIx path. Otherwise the ranks of the two
# emulated nodes would try to use shared memory with each other.
cluster_node() {
  install -d "$cluster_root/spool/$1" "$cluster_root/pmix-$1"
  # shellcheck disable=SC2016 # expanded by the inner shell
  unshare --uts --mount --propagation slave bash -ec '
    hostname "$1"
    mount --bind "$2/pmix-$1" "$2/pmix"
    mount --bind "$2/etc/hosts" /etc/hosts
    exec slurmd -f "$2/etc/slurm.conf" -N "$1"' _ "$1" "$cluster_root"
}

cluster_idle() { [[ $(sinfo -h -N -o %T 2>/dev/null | grep -c '^idle$') -eq $cluster_nodes ]]; }

cluster_start() {
  local tool n
  cluster_root=$1
  PATH=$PATH:/usr/sbin:/sbin
  export SLURM_CONF=$cluster_root/etc/slurm.conf
  ((EUID == 0)) || cluster_fail "only root can" || return 1
  for tool in munged slurmctld slurmd sinfo unshare; do
    command -v "$tool" >/dev/null || cluster_fail "$tool is missing: install slurm-wlm and munge" || return 1
  done
  cluster_folders
  cluster_munge || return 1
  cluster_configure
  slurmctld -f "$SLURM_CONF" || cluster_fail "slurmctld" || return 1
  for ((n = 1; n <= cluster_nodes; n++)); do cluster_node "node$n" || cluster_fail "node$n" || return 1; done
  cluster_retry 30 cluster_idle || cluster_fail "nodes do not come up"
}

# cluster_end PID-FILE NAME: ends the process of PID-FILE, if its name is still NAME
cluster_end() {
  local pid
  pid=$(cat "$1" 2>/dev/null) || return 0
  [[ $(ps -o comm= -p "$pid" 2>/dev/null) == "$2" ]] || return 0
  kill -TERM "$pid" 2>/dev/null
  cluster_retry 10 cluster_gone "$pid" || kill -KILL "$pid" 2>/dev/null
}
cluster_gone() { [[ ! $(ps -o state= -p "$1" 2>/dev/null) =~ ^[^Z] ]]; }
cluster_empty() { [[ -z $(squeue -h 2>/dev/null) ]]; }

cluster_stop() {
  local file
  [[ -n $cluster_root && -d $cluster_root ]] || return 0
  if [[ -n $(timeout 5 squeue -h -o %A 2>/dev/null) ]]; then
    timeout 10 scancel --user=root 2>/dev/null
    cluster_retry 15 cluster_empty
  fi
  for file in "$cluster_root"/run/node*.pid; do cluster_end "$file" slurmd; done
  cluster_end "$cluster_root/run/slurmctld.pid" slurmctld
  cluster_end "$cluster_root/munge/munged.pid" munged
  rm -rf "$cluster_root"
  cluster_root=''
}
