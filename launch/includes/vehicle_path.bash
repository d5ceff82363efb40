# The absolute path of a vehicle file, for a parameter: roslaunch starts its nodes in another folder than the caller's.
# usage (command of a param): bash vehicle_path.bash FILE
set -euo pipefail
[ -f "$1" ] || { echo "vehicle_file is '$1', which is no file (seen from $PWD)" >&2; exit 2; }
printf %s "$(realpath -- "$1")"
