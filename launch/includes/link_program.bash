# Start of a program of the link under roslaunch: draws the link's key if there is none yet (both ends share it) and
# notes the process id.
# usage (launch-prefix): bash link_program.bash KEY_FILE PID_FILE|- PROGRAM [ARGUMENTS...]
set -euo pipefail
key_file=$1 pid_file=$2
program=$3
shift 2
mkdir -p "$(dirname "$key_file")"
exec 9>"$key_file.lock"
flock 9
[ -e "$key_file" ] || "$(dirname "$program")/radio_bridge" --create-key "$key_file" >/dev/null
exec 9>&-
[ "$pid_file" = - ] || echo $$ >"$pid_file"
exec "$@"
