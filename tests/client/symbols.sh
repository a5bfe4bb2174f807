#!/bin/sh
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: 2026 The Pursuit authors
#
# symbols.sh LIBRARY HEADER: the library exports what the header declares, and nothing else.
set -eu
exported=$(nm -D --defined-only "$1" | awk '{ sub(/@.*/, "", $3); print $3 }' | sort)
declared=$(grep -o '^PURSUIT_API.*' "$2" | grep -o 'pursuit_[a-z_]*(' | tr -d '(' | sort)
if [ "$exported" != "$declared" ]; then
	echo "exported:" $exported
	echo "declared:" $declared
	exit 1
fi
