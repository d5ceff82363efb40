# The absolute path of a vehicle file, for a parameter: roslaunch starts its nodes in another folder than the caller's.
# With --check the vehicle and all that it names are read first, so that a wrong one ends roslaunch with one message.
# usage (command of a param): bash vehicle_path.bash [--check] FILE
set -euo pipefail
check=false
[ "$1" != --check ] || { check=true; shift; }
[ -f "$1" ] || { echo "vehicle_file is '$1', which is no file (seen from $PWD)" >&2; exit 2; }
if $check; then
  program=$(catkin_find --first-only --libexec snapwing snapwing)
  [ -x "$program" ] || { echo "the program snapwing is not there; build the workspace and source its setup.bash" >&2; exit 2; }
  "$program" vehicle check --path "$1"
else
  printf %s "$(realpath -- "$1")"
fi
