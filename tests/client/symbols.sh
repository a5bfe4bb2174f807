#!/bin/sh
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: 2026 The Pursuit authors
#
# symbols.sh LIBRARY HEADER MAP SONAME VERSION: the library exports what the header declares, each under the version that
# the map says, and nothing else; its name and the header's version are those of the build.
set -eu
library=$1 header=$2 map=$3 soname=$4 version=$5
wrong=0

expect() {
	if [ "$2" != "$3" ]; then
		printf '%s:\n%s\nexpected:\n%s\n' "$1" "$2" "$3"
		wrong=1
	fi
}

exported=$(nm -D --defined-only "$library" | awk '$2 != "A" { sub(/@@/, "@", $3); print $3 }' | LC_ALL=C sort)
listed=$(awk '/^PURSUIT_[0-9.]+ \{/ { node = $1 } /^\t\tpursuit_/ { sub(/;/, "", $1); print $1 "@" node }' "$map" | LC_ALL=C sort)
declared=$(grep -o '^PURSUIT_API.*' "$header" | grep -o 'pursuit_[a-z_]*(' | tr -d '(' | LC_ALL=C sort)
expect "exported" "$exported" "$listed"
expect "declared in pursuit.h" "$declared" "$(echo "$listed" | sed 's/@.*//')"
expect "name of the library" "$(readelf -d "$library" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')" "$soname"
expect "version in pursuit.h" "$(awk '/^#define PURSUIT_VERSION_/ { v = v s $3; s = "." } END { print v }' "$header")" "$version"
exit $wrong
