#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Layout of the C sources by clang-format 14 (that of Debian 12; other versions differ in details).
#
#   scripts/format.sh          changes the files
#   scripts/format.sh check    names the files that would change; exit status 1 if any
set -eu
cd "$(dirname "$0")/.."
tool=$(command -v clang-format-14 || command -v clang-format) || { echo "clang-format is missing: scripts/deps.sh ci" >&2; exit 1; }
case $("$tool" --version) in
*'version 14.'*) ;;
*) echo "$("$tool" --version): the layout is that of version 14" >&2; [ "${1-}" != check ] || exit 1 ;;
esac
set_of_files() { find src include tools tests examples bench -name '*.[ch]' ! -path '*/build*' -print0; }
if [ "${1-}" = check ]; then
	set_of_files | xargs -0 "$tool" --dry-run --Werror
else
	set_of_files | xargs -0 "$tool" -i
fi
