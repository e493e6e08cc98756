#!/usr/bin/env bash
# Stands before a compiler: gives it the object that another build of the same sources has already, made by the same command.
# What is tested is how the library is configured, linked and installed; the same command makes the same object. The sources may
# have been copied elsewhere: the folder of the first -I is where they are.
#
#   objects_of.sh BUILD COMPILER ARGUMENT...        (as CMAKE_CXX_COMPILER_LAUNCHER)
set -u
build=$1
shift
source='' object='' depfile='' command='' root=''
arguments=("$@")
while [ $# -gt 0 ]; do
    case $1 in
        -c) source=$2; shift ;;
        -o) object=$2; shift ;;
        -MF) depfile=$2; shift ;;
        -MT) shift ;;
        -MD) ;;
        *)
            case $1 in -I*) root=${root:-${1#-I}} ;; esac
            command="$command $1"
            ;;
    esac
    shift
done

home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$build/CMakeCache.txt")
original=${source/#"$root"/$home}
command=${command//" -I$root"/" -I$home"}

# The same words but for the object's name, in the list of commands that cmake writes for editors.
same=$(awk -v source="$original" -v command="$command" '
    /"directory":/ { split($0, field, "\""); folder = field[4] }
    /"command":/ && index($0, " -c " source "\"") {
        sub(/^ *"command": "/, ""); sub(/",?$/, ""); gsub(/\\"/, "") # quotes of a word that a shell would read
        n = split($0, word, " "); made = ""; found = ""
        for (i = 1; i <= n; ++i)
            if (word[i] == "-o") found = folder "/" word[++i]
            else if (word[i] == "-c") ++i
            else made = made " " word[i]
        # Where that build has a launcher, its name comes first.
        if (substr(made, length(made) - length(command) + 1) == command) { print found; exit }
    }' "$build/compile_commands.json" 2>/dev/null)
if [ -n "$source" ] && [ -n "$same" ] && [ "$same" -nt "$original" ] &&
    cmp -s "$source" "$original"; then
    [ -z "$depfile" ] || printf '%s:\n' "$object" >"$depfile"
    exec cp "$same" "$object"
fi
exec "${arguments[@]}"
