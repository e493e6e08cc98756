# Which method gives which accuracy at which price? Position level, chains of 100 bonds, one thread. Also given: problem.
set logscale xy
set format xy "10^{%T}"
set xlabel "time per bond and call (ns); bars: quartiles"
set ylabel "largest |d^2 - a^2| / a^2 left"
set bars small
chains = system(sprintf("awk -F, '$1 == \"position\" && $2 == \"%s\" && $4 == 100 && $3 > 1 && $6 == \"lincs\" && $7 ~ /order 12/ { print $3; exit }' '%s'", problem, results))
set title sprintf("Positions, %s, %s chains of 100 bonds: lower left is better", scene(problem), chains)
pick(method) = sprintf("$1 == \"position\" && $2 == \"%s\" && $3 == \"%s\" && $4 == 100 && $5 == 1 && $6 == \"%s\"", problem, chains, method)
sorted(c) = with_quartiles(c, "$9, $8, low, high") . " | sort -t, -k2,2g"
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/positions_%s.%s", out, problem, kind)
    plot for [i=1:5] sorted(pick(names[i]) . " && ($7 == \"default\" || $7 ~ /^(tolerance|order)/)") using 1:2:3:4 \
             with xerrorlines lw width(i) lc rgb colours[i] pt marks[i] ps (i == 1 ? 1.3 : 1) title titles[i], \
         sorted(pick("openmm-ccma") . " && $7 !~ /angles/") using 1:2:3:4 with xerrorlines lw 1.5 lc rgb colours[6] pt 4 title titles[6], \
         sorted(pick("openmm-ccma") . " && $7 ~ /angles/") using 1:2:3:4 with xerrorlines lw 1.5 dt 2 lc rgb colours[6] pt 5 title "CCMA, told the angles"
    unset output
}
