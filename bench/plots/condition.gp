# Does the error of the multipliers grow with the condition number? Chains of 64 bonds.
set logscale xy
set format xy "10^{%T}"
set xlabel "condition number of Z, scaled to ones on its diagonal"
set ylabel "largest error of {/Symbol l} / its scale"
set yrange [1e-17:10]
set title "Error of the multipliers, chains of 64 bonds"
pick(method) = sprintf("$6 == \"%s\" && $7 ~ /^condition/", method)
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/condition.%s", out, kind)
    plot for [i in "11 7 10 1"] rows(pick(names[int(i)]), "substr($7, 11), $8") using 1:2 \
             with linespoints lw width(int(i)) lc rgb colours[int(i)] pt marks[int(i)] title titles[int(i)]
    unset output
}
