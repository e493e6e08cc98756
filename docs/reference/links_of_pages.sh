#!/bin/sh
# What doxygen reads of a page: links to a heading of another page lead to the page, as doxygen has names of its own for
# headings, and links to other files of the tree lead to their copies beside the HTML (scripts/docs).
#
#   links_of_pages.sh FILE
end=$(printf '\001')
sed -E "s/\]\(([^)#:]*\.md)#[^)]*\)/](\1)/g
    s/\.md\)/.md$end/g
    s/\]\((\.\.\/)+([^)$end]*)\)/](\2)/g
    s/$end/)/g" "$1"
