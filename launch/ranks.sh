# shellcheck shell=bash
# SPDX-License-Identifier: Apache-2.0
# For scripts that start ranks with mpirun: source launch/ranks.sh.

state=

# What Open MPI must be told so that it starts anywhere without a word of warning.
set_up_mpi() {
  # As root, as in containers; straight to shared memory and TCP: looking for InfiniBand and the like costs 0.2 s
  # and warns where it finds half of it.
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  export OMPI_MCA_pml=${OMPI_MCA_pml:-ob1} OMPI_MCA_btl=${OMPI_MCA_btl:-self,vader,tcp}
  # Reading another process's memory is forbidden in most containers, and found out only on the way.
  export OMPI_MCA_btl_vader_single_copy_mechanism=${OMPI_MCA_btl_vader_single_copy_mechanism:-none}
  export HWLOC_HIDE_ERRORS=2
}

# A folder for the master's status, as $state/status: make_state SCRIPT.
make_state() {
  state=$(mktemp -d) || { echo "goldthread: error: $1: no temporary folder (free some space)" >&2; return 4; }
  trap 'rm -rf "$state"' EXIT
}

# run_mpirun SCRIPT COMMAND ARGUMENT...: mpirun with these arguments, which run `launch/master $state/status` as
# rank 0. It goes on when a rank dies (--enable-recovery) and then always ends with 0: the master's own status comes back
# in the file. COMMAND is goldthread's.
run_mpirun() {
  local script=$1 command=$2 status='' signal='' mpirun='' quieted filter
  shift 2
  trap 'signal=INT; kill -TERM "$mpirun" 2>/dev/null' INT
  trap 'signal=TERM; kill -TERM "$mpirun" 2>/dev/null' TERM HUP
  # What Open MPI says, harmlessly, of each rank that ends early or with a status.
  exec {quieted}> >(exec grep --line-buffered -v 'PMIX ERROR: BAD-PARAM .*pmix_event_notification' >&2)
  filter=$!
  # A session of its own, so that Ctrl-C reaches mpirun once and through this script alone: told twice it
  # drops its ranks. Should this script be killed outright, mpirun is told too.
  # Such a session is a scheduling group as well (autogroup): one that serves leaves the cores to a browser on
  # this machine whenever that wants them.
  setsid setpriv --pdeathsig TERM bash -c '{ echo "$0" >/proc/self/autogroup; } 2>/dev/null; exec "$@"' \
    "$([[ $command == serve ]] && echo 19 || echo 0)" mpirun --enable-recovery --bind-to none "$@" \
    2>&"$quieted" &
  mpirun=$!
  [[ -z $signal ]] || kill -TERM "$mpirun" 2>/dev/null
  while kill -0 "$mpirun" 2>/dev/null; do wait "$mpirun"; done
  exec {quieted}>&-
  # The last lines; but who still holds mpirun's output, as ssh to a lost host may, is not waited for.
  for _ in {1..20}; do
    kill -0 "$filter" 2>/dev/null || break
    sleep 0.05
  done
  kill "$filter" 2>/dev/null
  wait "$filter"
  [[ ! -s $state/status ]] || status=$(<"$state/status")
  finish "$script" "$command" "$status" "$signal"
}

# The status to end with: finish SCRIPT COMMAND STATUS SIGNAL, the last two empty where there was none.
finish() {
  if [[ $4 ]]; then
    [[ $2 == serve && ${3:-0} == 0 ]] && return 0
    [[ $4 == INT ]] && return 130
    return 143
  fi
  case $3 in
    [0-4]) return "$3" ;;
    '') echo "goldthread: error: $1: the ranks could not be started or were killed (see above)" >&2 ;;
    *) echo "goldthread: error: $1: the master ended with status $3 (please report this)" >&2 ;;
  esac
  return 4
}
