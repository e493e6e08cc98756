#!/bin/sh
# The wheel with the library in it: installed by pip in an empty virtual environment, without a network and with no other
# library to be found, it calculates; and the package without a library says what is missing.
#
#   wheel.sh SOURCE BUILD WORK PYTHON CMAKE        Exit status 77: this Python has no venv or no pip.
set -eu
source=$1 build=$2 work=$3 python=$4 cmake=$5
unset HOLONOMIC_LIBRARY PYTHONPATH LD_LIBRARY_PATH LD_PRELOAD || :
rm -rf "$work"
mkdir -p "$work"
"$python" -c 'import venv, ensurepip' 2>/dev/null || { echo "left out: $python has no venv"; exit 77; }

"$cmake" --build "$build" --target holonomic_wheel >"$work/build.log" 2>&1 || { cat "$work/build.log"; exit 1; }
wheel=$(ls "$build"/python/*.whl)
echo "$wheel"

# numpy is the system's, as there is no network; all else of the environment is empty.
began=$(date +%s)
"$python" -m venv --system-site-packages "$work/environment"
"$work/environment/bin/pip" install --quiet --no-index "$wheel"
cd "$work"
cat >try.py <<'END'
import numpy, os, sys
import holonomic as hol
assert hol.__file__.startswith(sys.prefix), hol.__file__
libraries = {line.split()[-1] for line in open("/proc/self/maps") if "libholonomic" in line or "libgomp" in line}
assert libraries and all(name.startswith(os.path.realpath(sys.prefix)) for name in libraries), libraries
molecules = hol.Molecules([0, 1, 1, 1])
molecules.add([(0, 1), (1, 2), (2, 3)], 1.0)
r = -numpy.outer(range(4), [0, 0, 1.0])
print(molecules.forces(r, None, numpy.outer([0, 1, 1, 1], [0, 0, -10.0])).tensions)
END
"$work/environment/bin/python" try.py | tee printed
[ "$(cat printed)" = "[30. 20. 10.]" ]
echo "the first result after $(($(date +%s) - began)) s"

# The package alone needs an installed library, and says so.
"$work/environment/bin/pip" uninstall --quiet --yes holonomic
cp -r "$source/python" "$source/LICENSE" "$work"
"$work/environment/bin/pip" install --quiet --no-index "$work/python"
HOLONOMIC_LIBRARY=$(ls "$build"/capi/libholonomic.so.0) "$work/environment/bin/python" try.py 2>/dev/null && exit 1 # not the wheel's own
if HOLONOMIC_LIBRARY=$work/nothing.so "$work/environment/bin/python" -c 'import holonomic' 2>message; then exit 1; fi
grep -q "ImportError: the library of holonomic could not be loaded" message
HOLONOMIC_LIBRARY=$build/capi/libholonomic.so "$work/environment/bin/python" -c 'import holonomic; print(holonomic.version())'
