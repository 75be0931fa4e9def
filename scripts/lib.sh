# Shared by the scripts (source it): where things are, and an environment in which MPI and BLAS behave.
set -euo pipefail
whirl_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# Ranks are our parallelism; BLAS threads beside them only get in the way.
# nproc counts no more than OMP_NUM_THREADS.
cores=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc)
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
if [ "$(id -u)" = 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi

say() { printf '%s\n' "$*" >&2; }
die() {
  say "$(basename "$0"): $*"
  exit 1
}

# The first Python that can read results. Debian's packages belong to /usr/bin/python3, which need not be the first on PATH.
find_python() {
  local candidate
  for candidate in ${WHIRL_PYTHON:-} /usr/bin/python3 python3; do
    # Whether they are there, not in this folder; to import them takes longer than to draw a picture.
    if "$candidate" -c 'import sys; sys.path.remove("")
from importlib.util import find_spec
sys.exit(any(getattr(find_spec(name), "origin", None) is None for name in ("h5py", "numpy", "matplotlib")))' 2>/dev/null; then
      printf '%s\n' "$candidate"
      return
    fi
  done
  die "no Python with h5py, numpy and matplotlib; run scripts/setup"
}

# Runs a command with its output in a file, shown only if the command fails.
quietly() {
  local log
  log=$(mktemp)
  if "$@" >"$log" 2>&1; then
    rm -f "$log"
  else
    local code=$?
    tail -n 60 "$log" >&2
    rm -f "$log"
    say "failed: $*"
    return "$code"
  fi
}

# Configures and builds the release preset in build/: the targets named, or everything.
build_release() {
  cd "$whirl_root"
  quietly cmake --preset release
  # Configuring has just looked for new files, so ninja's plan is complete; silence if there is nothing to do.
  if ! ninja -C build -n "$@" | grep -q 'no work to do'; then
    NINJA_STATUS='[%f/%t %es] ' cmake --build --preset release ${1:+--target "$@"} >&2
  fi
  cd - >/dev/null
}
