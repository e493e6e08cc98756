#!/usr/bin/env bash
# No two types of the core share a name, in whatever folder or namespace they are, and so in each host: who looks for one finds it. What
# stands within a type has a name that no type outside has; several types may have one of the same name, which is read with theirs:
# Groups::Mark, Kinds::Mark. Not looked at: specialisations of templates, and what one file declares for several systems.
#
#   namesakes.sh TOP
set -u
cd "$1" || exit 1
declared='(struct|class|enum|enum class|union) (HOL[A-Z_]+ )?[A-Za-z0-9_]+( final)?( : [^{;]*)? \{'
types() { # FOLDER INDENT: name and file of each
    grep -rnE --include='*.hpp' --include='*.h' --include='*.cpp' --exclude-dir=tests --exclude-dir=build "^$2$declared" "$1" |
        sed -E 's/^([^:]*):[0-9]+: *(struct|class|enum class|enum|union) (HOL[A-Z_]+ )?([A-Za-z0-9_]+).*/\4 \1/' | sort -u
}
status=0 all=0
for folder in core hosts/*/; do
    outer=$(types "$folder" '') inner=$(types "$folder" ' +')
    [ -n "$outer" ] || continue
    all=$((all + $(wc -l <<<"$outer") + $(wc -l <<<"$inner")))
    twice=$({ cut -d' ' -f1 <<<"$outer"; cut -d' ' -f1 <<<"$inner" | sort -u; } | sort | uniq -d | grep .) || continue
    grep -E "^($(paste -sd'|' <<<"$twice")) " <<<"$outer"$'\n'"$inner"
    status=1
done
[ $status -ne 0 ] || echo "$all types, none with a namesake"
exit $status
