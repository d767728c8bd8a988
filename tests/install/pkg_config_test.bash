#!/bin/bash
# pkg_config_test.bash LIBRARIES COMPILER SOURCE: builds SOURCE with what pkg-config says of an installation, whose
# libraries are in this folder, and runs it.
set -euo pipefail

libraries=$1
compiler=$2
source=$3
if ! command -v pkg-config >/dev/null; then
  echo "skipped: pkg-config is not installed"
  exit
fi
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT

export PKG_CONFIG_PATH=$libraries/pkgconfig
read -r -a flags < <(pkg-config --cflags --libs pingvox)
"$compiler" -std=c++20 "$source" -o "$scratch/program" "${flags[@]}"
LD_LIBRARY_PATH=$libraries "$scratch/program"
needed=$(readelf -d "$scratch/program")
if [[ $needed != *libpingvox.so.* ]]; then
  echo "the program is not linked with the shared library"
  exit 1
fi
