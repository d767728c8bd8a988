#!/bin/bash
# version_test.bash SOURCE VERSION: the files that have the version of the project written in them have this one, that of
# CMakeLists.txt. All others take it from there.
set -euo pipefail

source=$1
version=$2
failures=0

# has FILE EXPRESSION: whether a line of FILE matches this extended regular expression.
has() {
  if ! grep -qE -- "$2" "$source/$1"; then
    echo "$1: no line matches '$2'"
    failures=$((failures + 1))
  fi
}

quoted=${version//./\\.}
has CITATION.cff "^version: $quoted\$"
has CHANGELOG.md "^## (\[Unreleased\] - $quoted|\[$quoted\] - [0-9]{4}-[0-9]{2}-[0-9]{2})\$"
has docs/man/pingvox.1 "^\.TH PINGVOX 1 \"[^\"]*\" \"pingvox $quoted\""
has packaging/blueos/Dockerfile "^ARG VERSION=$quoted\$"
has packaging/blueos/README.md "^\| Docker image, tag \| .*\`$quoted\`"
# Packages are named by the first entry.
first=$(sed -n '1s/^pingvox (\(.*\)) .*/\1/p' "$source/packaging/debian/changelog")
if [[ $first != "$version"-* ]]; then
  echo "packaging/debian/changelog: its first entry is of $first, not $version"
  failures=$((failures + 1))
fi

if ((failures > 0)); then exit 1; fi
echo "all name $version"
