#!/usr/bin/env bash
# Installs what building Isthmus needs on Debian 12; only what is missing. As root, or with sudo.
#   tools/install-dependencies.sh [--ci | --browser]
#     --ci       what checking needs besides (clang, libFuzzer, clang-format, clang-tidy, lld)
#     --browser  what the test of the page needs besides (chromium, chromedriver, selenium: about 500 MB); without it
#                that test is skipped
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config
  libeigen3-dev libceres-dev libsuitesparse-dev libcgal-dev libboost-dev libboost-graph-dev libnanoflann-dev
  liblcm-dev liblcm-bin libcpp-httplib-dev libjs-leaflet libcereal-dev
  libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libpng-dev libcairo2-dev libssl-dev zlib1g-dev libzstd-dev
  libgtest-dev libbenchmark-dev librapidcheck-dev python3 dpkg-dev file
)
if [[ "${1:-}" == "--ci" ]]; then
  packages+=(clang clang-format clang-tidy libclang-rt-14-dev lld)
elif [[ "${1:-}" == "--browser" ]]; then
  packages+=(chromium chromium-driver python3-selenium)
elif [[ "${1:-}" == -h || "${1:-}" == --help ]]; then
  sed -n '2,6s/^# \{0,1\}//p' "$0"
  exit 0
elif [[ $# -gt 0 ]]; then
  echo "usage: tools/install-dependencies.sh [--ci | --browser]" >&2
  exit 2
fi

if ! command -v dpkg-query > /dev/null; then
  echo "install-dependencies: this is no Debian; please install by hand: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2> /dev/null || true)
  [[ "$status" == installed ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo > /dev/null; then
    echo "install-dependencies: run as root, or install sudo; missing: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
