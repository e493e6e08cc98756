#!/usr/bin/env bash
# No two types of the core share a name, in whatever folder or namespace they are: who looks for one finds it. Not looked at: what stands
# within another type, specialisations of templates, and what one file declares for several systems.
#
#   namesakes.sh TOP
set -u
cd "$1" || exit 1
declared='^(struct|class|enum|enum class) [A-Za-z0-9_]+( final)?( : [^{;]*)? \{'
found=$(grep -rnE --include='*.hpp' --include='*.cpp' "$declared" core |
    sed -E 's/^([^:]*):[0-9]+:(struct|class|enum class|enum) ([A-Za-z0-9_]+).*/\3 \1/' | sort -u)
twice=$(cut -d' ' -f1 <<<"$found" | uniq -d)
[ -n "$twice" ] || { echo "$(wc -l <<<"$found") types, none with a namesake"; exit 0; }
grep -E "^($(paste -sd'|' <<<"$twice")) " <<<"$found"
exit 1
