#!/usr/bin/env bash
# Every local link of HTML pages leads to a file of their folder, and to a name in it if it gives one.
#
#   html_links.sh FOLDER
set -u
cd "$1" || exit 1
dead=0 n=0
while IFS= read -r line; do
    page=${line%%:*}
    link=${line#*:}
    case $link in
    *://* | mailto:* | javascript:* | '') continue ;;
    esac
    n=$((n + 1))
    file=${link%%#*} name=
    [ "$link" = "$file" ] || name=${link#*#}
    file=${file:-$page}
    file=${file//%20/ }
    if [ ! -e "$file" ]; then
        echo "$page: there is no $link"
        dead=$((dead + 1))
    elif [ -n "$name" ] && ! grep -qF -e "id=\"$name\"" -e "name=\"$name\"" "$file"; then
        echo "$page: $link names nothing there"
        dead=$((dead + 1))
    fi
done < <(grep -o 'href="[^"]*"' -- *.html | sed -E 's/:href="/:/; s/"$//' | sort -u)
echo "$n links, $dead of them dead"
[ "$n" -gt 0 ] && [ "$dead" -eq 0 ]
