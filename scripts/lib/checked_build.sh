# Shared by scripts/fuzz and scripts/sanitize: the core with clang, address and undefined-behaviour sanitizers and assertions.
# Source it; needs bash.
# shellcheck shell=bash

# A ROS environment names the libraries of another build, without checks, and they would be taken in place of those that are checked.
unset LD_LIBRARY_PATH

# usage: checked_build BUILD_FOLDER TARGETS...   Two callers may build at the same time. SNAPWING_CHECKED_FLAGS (default -O1)
# are the compiler's, one set for a folder: scripts/test does not optimise, which compiles in half of the time.
checked_build() {
  local root build=$1
  root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
  shift
  command -v clang++ > /dev/null || { echo "clang++ is missing (Debian packages clang, libclang-rt-14-dev)" >&2; exit 2; }
  mkdir -p "$build"
  (
    flock 9
    cmake -S "$root" -B "$build" -G Ninja -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DSNAPWING_WITH_ROS=OFF \
      -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS="${SNAPWING_CHECKED_FLAGS:--O1}" -DSNAPWING_FUZZ=ON \
      -DSNAPWING_SANITIZE=address,undefined > "$build/configure.log" 2>&1 || { cat "$build/configure.log"; exit 2; }
    ninja -C "$build" "$@" > "$build/build.log" || { grep -E -m 40 'error|FAILED|undefined' "$build/build.log"; exit 2; }
  ) 9> "$build/.lock"
}
