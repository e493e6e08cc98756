#!/usr/bin/env bash
# Every link of the documents leads somewhere: to a file of the tree, and to a heading if it names one. Addresses on the
# network are not looked at.
#
#   links.sh SOURCE [FILE...]     without files: all documents of the tree
set -u
source=$1
shift
cd "$source" || exit 1
if [ $# -eq 0 ]; then
    mapfile -t documents < <(find . -name '*.md' -not -path './build/*' -not -path './.git/*' | sort)
else
    documents=("$@")
fi

# What a heading is called in a link: small letters, no signs, hyphens for blanks.
headings() {
    awk '/^```/ { inside = !inside } !inside && /^#+ / { sub(/^#+ +/, ""); print }' "$1" |
        sed -E 's/\[([^]]*)\]\([^)]*\)/\1/g; s/`//g' | tr '[:upper:]' '[:lower:]' | sed -E 's/[^a-z0-9 _-]//g; s/ /-/g'
}
# File and target of each link; none in blocks of code.
links() {
    awk '/^```/ { inside = !inside } !inside && !/^    / { print }' "$1" | grep -o '\](\([^)]*\))' | sed -E 's/^\]\(//; s/\)$//'
}

dead=0 n=0
for document in "${documents[@]}"; do
    folder=$(dirname "$document")
    while IFS= read -r link; do
        case $link in
        *://* | mailto:* | '') continue ;;
        esac
        n=$((n + 1))
        file=${link%%#*} heading=
        [ "$link" = "$file" ] || heading=${link#*#}
        target=$document
        [ -z "$file" ] || target=$folder/$file
        if [ ! -e "$target" ]; then
            echo "$document: there is no $link"
            dead=$((dead + 1))
        elif [ -n "$heading" ] && ! headings "$target" | grep -qxF -- "$heading"; then
            echo "$document: $link names no heading of $(basename "$target")"
            dead=$((dead + 1))
        fi
    done < <(links "$document")
done
echo "$n links in ${#documents[@]} documents, $dead of them dead"
[ "$n" -gt 0 ] && [ "$dead" -eq 0 ]
