# Shared by the scripts: installs what is missing, builds, sets the environment. Source it; needs bash.
# shellcheck shell=bash
SNAPWING_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
SNAPWING_BUILD=${SNAPWING_BUILD:-$SNAPWING_ROOT/build}
# Debian's python3 must come first: another one on PATH lacks catkin and rospy.
export PATH=/usr/bin:$PATH

say() { printf '\033[1m==> %s\033[0m\n' "$*" >&2; }
die() { printf 'error: %s\n' "$*" >&2; exit 1; }

# usage: missing_packages LIST..., names of files beside this one
missing_packages() {
  local wanted installed
  wanted=$(cd "$SNAPWING_ROOT/scripts/lib" && cat "$@" | sed 's/#.*//' | tr -s ' \n' '\n' | sed '/^$/d' | sort -u)
  installed=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' 2>/dev/null | sed -n 's/^ii  *//p' | sort -u)
  comm -23 <(printf '%s\n' "$wanted") <(printf '%s\n' "$installed")
}

# usage: install_missing [more lists than packages.txt]
install_missing() {
  local missing as_root=()
  missing=$(missing_packages packages.txt "$@")
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || die "these Debian packages are missing, and there is neither root nor sudo: $missing"
    as_root=(sudo)
  fi
  say "installing $(wc -w <<<"$missing") Debian packages (a minute or two)"
  local log
  log=$(mktemp)
  # shellcheck disable=SC2086
  if ! { "${as_root[@]}" apt-get update && "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
         apt-get install -y --no-install-recommends $missing; } >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    die "apt-get failed; the whole log is in $log"
  fi
  rm -f "$log"
}

# A build folder that was copied along with the tree names another source folder; CMake would refuse it. One that
# SNAPWING_BUILD names elsewhere may be another tree's own and is left alone.
drop_foreign_build() {
  local cache=$SNAPWING_BUILD/CMakeCache.txt
  [ -f "$cache" ] || return 0
  grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$SNAPWING_ROOT" "$cache" && return 0
  [ "$SNAPWING_BUILD" -ef "$SNAPWING_ROOT/build" ] || die "SNAPWING_BUILD: $SNAPWING_BUILD belongs to another source folder"
  rm -rf "$SNAPWING_BUILD"
}

build() {
  local log=$SNAPWING_BUILD/build.log
  drop_foreign_build
  mkdir -p "$SNAPWING_BUILD"
  exec 9>"$SNAPWING_BUILD/.lock"
  flock 9 || die "cannot lock $SNAPWING_BUILD"
  if [ ! -f "$SNAPWING_BUILD/build.ninja" ]; then
    say "configuring"
    cmake -S "$SNAPWING_ROOT" -B "$SNAPWING_BUILD" -G Ninja -DPYTHON_EXECUTABLE=/usr/bin/python3 \
      -DSNAPWING_WERROR="${SNAPWING_WERROR:-OFF}" >"$log" 2>&1 || { tail -n 40 "$log" >&2; die "cmake failed"; }
  fi
  [ -f "$SNAPWING_BUILD/.built" ] || say "building (minutes, the first time)"
  ninja -C "$SNAPWING_BUILD" >"$log" 2>&1 || { grep -E -m 40 'error|FAILED' "$log" >&2; die "the build failed: $log"; }
  touch "$SNAPWING_BUILD/.built"
  flock -u 9
  exec 9>&-
}

# ROS environment of the build folder's devel space, kept off any ROS master that runs already.
use_ros() {
  # shellcheck disable=SC1091
  set +u; . "$SNAPWING_BUILD/devel/setup.bash"; set -u
  export ROS_HOSTNAME=localhost
  unset ROS_IP
}
