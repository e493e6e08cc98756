#!/bin/sh
# The programs of a page (README.md, docs/start.md): each compiled and run by its own line prints what the page says.
#
#   readme_programs.sh PAGE LANGUAGE...        LANGUAGE: c, fortran, python
set -eu
readme=$1
shift

# What is indented in a section, outside of programs; of the programs, the first one.
lines_of() {
    awk -v title="## $1" '
        /^```/ { program = !program }
        /^## / && !program { inside = $0 == title }
        inside && !program && /^    / { print substr($0, 5) }' "$readme"
}
program_in() {
    awk -v start="^\`\`\`$1\$" '$0 ~ start { inside = 1; next } /^```/ && inside { exit } inside' "$readme"
}

for language in "$@"; do
    case $language in
        c) section=C ;;
        fortran) section=Fortran ;;
        python) section=Python ;;
    esac
    # The first line is the command, which names the program, and the others are what it prints.
    lines_of "$section" | head -n 1 >command_line
    lines_of "$section" | tail -n +2 >expected
    program=$(sed 's/^[a-z0-9]* \([a-z0-9.]*\).*/\1/' command_line)
    program_in "$language" >"$program"
    [ -s "$program" ] && [ -s expected ] || { echo "README has no program in $language, or does not say what it prints"; exit 1; }
    cat command_line
    . ./command_line | tee printed
    diff expected printed
done
