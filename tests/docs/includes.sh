#!/usr/bin/env bash
# Includes go down: each folder of the core uses those that stand before it in this table, and no others.
#
#   includes.sh TOP
set -u
cd "$1" || exit 1
# A folder, and which files of core/ those in it may include, as an extended regular expression.
base='(error|index|status|double_pair|kernel_choice)\.hpp'
call='kernels/[a-z]*\.hpp'
given="$base|plan/|$call|molecules/given/"
set="$base|plan/|$call|caller/|molecules/"
run="$set|extended/|run/"
kernels="plan/|$call"
below='isa arithmetic memory eliminate extended newton molecules bodies kept verbs'
table="
plan                 plan/
kernels/isa          kernels/isa/
molecules/given      $given
molecules/planned    $given|kernels/extended/scratch\.hpp|molecules/(planned/|chains\.hpp)
molecules/asked      $set|rigid/bodies\.hpp
molecules            $set|rigid/(bodies|cliques)\.hpp
caller               $base|$call|caller/
extended             $set|kernels/extended/|extended/
run                  $run
inverse              $run|inverse/
long_step            $run|long_step/|reference\.hpp
device               $set|device/
partition            $base|partition/
rigid                $run|long_step/|kernels/bodies/|rigid/|[a-z]*\.hpp
factors              $run|rigid/|factors/|[a-z]*\.hpp
"
status=0
not_in() { # FOLDER ALLOWED: includes in it that are not allowed, which have to be none
    local found
    [ -d "core/$1" ] || { echo "core/$1 is no folder"; status=1; }
    found=$(grep -rnE --include="*.cpp" --include="*.hpp" "#include \"" "core/$1" | grep -vE "^core/($3):|#include \"(core/($2)|[^/]*\")")
    [ -z "$found" ] || { echo "$found"; echo "^ core/$1 may include: $2"; status=1; }
}
while read -r folder allowed; do
    [ -z "$folder" ] && continue
    if [ "$folder" = molecules ]; then not_in "$folder" "$allowed" 'molecules/[a-z]*/.*'; else not_in "$folder" "$allowed" '-'; fi
done <<<"$table"
# The kernels' folders, of which each may use those before it; besides, rules and declarations that several share.
allowed=$kernels
for folder in $below; do
    allowed+="|kernels/$folder/"
    also=
    [ $folder = extended ] && also='|kernels/newton/rules\.hpp'
    [ $folder = bodies ] && also='|kernels/molecules/atoms/'
    [ $folder = kept ] && also='|kernels/verbs/verbs\.hpp'
    not_in "kernels/$folder" "$allowed$also" '-'
done
if grep -rn '#include "capi/' core; then echo '^ core includes nothing of capi'; status=1; fi
[ $status -ne 0 ] || echo "all includes go down"
exit $status
