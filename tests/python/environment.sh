# What the tests of installing share; to be read with `.`, with source=, work= and python= set. It makes the folder $work, an empty
# virtual environment in it, and there
#
#   pip ARGUMENT...      the environment's pip; python is the environment's, too
#   source_archive       makes $work/holonomic-*.tar.gz of what git has of $source
#   calculates FOLDER    the package that is installed uses a library in FOLDER, and is right
#
# Ends with 77 where this Python has no venv, no pip or no setuptools.
unset HOLONOMIC_LIBRARY HOLONOMIC_PREFIX HOLONOMIC_WHEEL_LIBRARIES PYTHONPATH LD_LIBRARY_PATH LD_PRELOAD || :
rm -rf "$work"
mkdir -p "$work"
"$python" -c 'import venv, ensurepip' 2>/dev/null || { echo "left out: $python has no venv"; exit 77; }
"$python" -c 'import setuptools, wheel' 2>/dev/null || { echo "left out: $python has no setuptools or no wheel"; exit 77; }

# numpy and setuptools are the system's, as there is no network; all else of the environment is empty.
"$python" -m venv --system-site-packages "$work/environment"
PATH=$work/environment/bin:$PATH
pip() { "$work/environment/bin/python" -m pip "$@"; }

source_archive() {
    mkdir "$work/clean"
    (cd "$source" && git ls-files -z 2>/dev/null | xargs -0 -r cp --parents -t "$work/clean") || cp -r "$source/." "$work/clean"
    (cd "$work/clean" && python -c "from setuptools import build_meta; build_meta.build_sdist('$work')") >"$work/sdist.log" 2>&1
}

calculates() {
    (cd "$work" && python "$source/tests/python/installed.py" "$1")
}
