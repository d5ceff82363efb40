# A folder with Debian packages of another architecture, unpacked and not installed. Source it after workspace.sh; needs bash.
# shellcheck shell=bash

# The core's libraries: the section of that name of packages.txt, without programs and with what a compiler needs.
sysroot_packages() {
  sed -n '/^# core libraries/,/^# report/p' "$SNAPWING_ROOT/scripts/lib/packages.txt" | grep -v -e '^#' -e '-bin$'
  printf '%s\n' libc6-dev libstdc++-12-dev
}

# usage: make_sysroot FOLDER ARCHITECTURE; apt gets lists and a cache of its own, the machine's stay as they are
make_sysroot() {
  local folder=$1 architecture=$2 wanted
  wanted=$(sysroot_packages)
  [ "$(cat "$folder/.packages" 2>/dev/null)" = "$wanted" ] && return 0
  say "fetching the libraries for $architecture"
  local apt=$folder/../apt
  mkdir -p "$folder/usr/lib" "$folder/usr/bin" "$folder/usr/sbin" "$apt/state/lists/partial" "$apt/cache/archives/partial"
  for link in lib bin sbin; do ln -sfn "usr/$link" "$folder/$link"; done
  : > "$apt/status"
  local options=(-o "APT::Architecture=$architecture" -o "APT::Architectures=$architecture" -o "Dir::State=$apt/state"
                 -o "Dir::State::status=$apt/status" -o "Dir::Cache=$apt/cache" -o APT::Install-Recommends=0 -o APT::Sandbox::User=root)
  { apt-get "${options[@]}" update && # shellcheck disable=SC2086
    apt-get "${options[@]}" install --download-only -y $wanted; } > "$apt/log" 2>&1 || { tail -20 "$apt/log" >&2; die "apt-get failed: $apt/log"; }
  local package
  for package in "$apt"/cache/archives/*.deb; do
    dpkg-deb --fsys-tarfile "$package" | tar -x --keep-directory-symlink -C "$folder"
  done
  printf '%s\n' "$wanted" > "$folder/.packages"
}
