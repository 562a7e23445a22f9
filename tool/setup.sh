# Shared by tool/run and tool/test: installs what is missing and configures build/. Sourced, not run.

softreel_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# Installs the packages of a list that are missing; asks the package manager for nothing if none is. Where a line names a
# program too, the package counts as installed if that program is there.
softreel_install() {
  local list=${1:-tool/packages.txt} missing=() package program
  while read -r package program; do
    case "$package" in '' | '#'*) continue ;; esac
    if [ -n "$program" ] && command -v "$program" >/dev/null; then continue; fi
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done <"$softreel_root/$list"
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "installing ${#missing[@]} packages: ${missing[*]}" >&2
  local become=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "softreel needs these packages. As root: apt-get install ${missing[*]}" >&2
      return 2
    }
    become=(sudo)
  fi
  # A machine that has just started may be installing updates of its own: its lock is waited for.
  "${become[@]}" apt-get -o DPkg::Lock::Timeout=300 update -qq >&2 || {
    echo "apt-get could not fetch the lists of packages; wanted: ${missing[*]}" >&2
    return 2
  }
  "${become[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 install -y -qq \
    --no-install-recommends "${missing[@]}" >/dev/null || {
    echo "apt-get could not install: ${missing[*]}" >&2
    return 2
  }
}

# Installs the clients that tests/clients asks: packages, and npm packages into build/clients.
softreel_install_clients() {
  softreel_install tests/clients/packages.txt
  local from=$softreel_root/tests/clients to=$softreel_root/build/clients log
  mkdir -p "$to"
  # What was installed whole, which npm says last: an interrupted installation is begun again.
  cmp -s "$from/package-lock.json" "$to/installed.json" && [ -d "$to/node_modules" ] && return 0
  cp "$from/package.json" "$from/package-lock.json" "$to"
  log=$(cd "$to" && npm ci --ignore-scripts --no-audit --no-fund 2>&1) || {
    echo "$log" >&2
    return 2
  }
  cp "$from/package-lock.json" "$to/installed.json"
}

# Compilers to run at once: as ninja chooses, but for 1.5 GB of memory each, which the largest groups of sources take.
softreel_jobs() {
  local by_memory by_cores
  by_memory=$(awk '/^MemTotal:/ { print int($2 / 1500000) }' /proc/meminfo)
  by_cores=$(($(nproc) + 2))
  [ "$by_memory" -ge 1 ] || by_memory=1
  echo $((by_memory < by_cores ? by_memory : by_cores))
}

# Configures a build folder: softreel_configure FOLDER [CMake options ...]. Without options, the one cache of build/.
softreel_configure() {
  local folder=$1
  shift
  [ $# -gt 0 ] || set -- -DSOFTREEL_WITH_EMBREE=ON -DSOFTREEL_WITH_EGL=ON \
    -DSOFTREEL_WITH_ASSIMP=ON -DSOFTREEL_WITH_OPENVDB=ON -DSOFTREEL_BUILD_TESTS=ON -DSOFTREEL_BUILD_BENCHMARKS=ON -DSOFTREEL_WERROR=ON \
    -DCMAKE_BUILD_TYPE=Release
  local log
  log=$(cmake -S "$softreel_root" -B "$softreel_root/$folder" -G Ninja "$@" 2>&1) || {
    echo "$log" >&2
    return 1
  }
}

# Builds targets of a folder: softreel_build FOLDER TARGET ... (quiet unless it fails).
softreel_build() {
  local folder=$1 log
  shift
  echo "building $folder: $*" >&2
  log=$(cmake --build "$softreel_root/$folder" -j "$(softreel_jobs)" --target "$@" 2>&1) || {
    echo "$log" | tail -n 60 >&2
    return 1
  }
}
