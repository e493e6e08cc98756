#!/bin/sh
# README's program in Python, by its own line, prints what README says.
#
#   run_readme.sh SOURCE WORK PYTHON
set -eu
source=$1 work=$2 python=$3
rm -rf "$work"
mkdir -p "$work/bin"
cd "$work"
printf '#!/bin/sh\nexec %s "$@"\n' "$python" >bin/python3
chmod +x bin/python3
PATH=$work/bin:$PATH
export PATH
"$source/tests/install/readme_programs.sh" "$source/README.md" python
