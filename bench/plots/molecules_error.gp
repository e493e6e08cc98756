# Which method gives which accuracy at which price? Positions of molecules, one thread. Given: problem.
set logscale xy
set format xy "10^{%T}"
set xlabel "time per bond and call (ns); bars: quartiles"
set ylabel "largest |d^2 - a^2| / a^2 left"
set bars small
array methods[7] = ["holonomic", "sparse-newton", "quasi-newton", "rattle", "lincs", "openmm", "settle"]
array called[7] = ["holonomic", "sparse Newton", "quasi-Newton", "RATTLE", "LINCS", "OpenMM", "SETTLE"]
array hues[7] = ["#111111", "#d55e00", "#009e73", "#0072b2", "#cc79a7", "#e69f00", "#56b4e9"]
array shapes[7] = [7, 5, 9, 13, 11, 4, 12]
# The first of the sizes: many molecules that fit into the cache.
size = system(sprintf("awk -F, '$1 == \"position\" && $2 == \"%s\" && $6 == \"lincs\" { print $3, $4; exit }' '%s'", problem, results))
set title sprintf("Positions, %s, %s molecules of %s bonds: lower left is better", problem, word(size, 1), word(size, 2))
pick(method) = sprintf("$1 == \"position\" && $2 == \"%s\" && $3 == %s && $5 == 1 && $6 == \"%s\" && ($7 == \"default\" || $7 ~ /^(tolerance|order)/)", problem, word(size, 1), method)
sorted(c) = with_quartiles(c, "$9, $8, low, high") . " | sort -t, -k2,2g"
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/positions_%s.%s", out, problem, kind)
    plot for [i=1:7] (count(pick(methods[i])) > 0 ? sorted(pick(methods[i])) : "< echo 1,NaN") using 1:2:3:4 \
             with xerrorlines lw width(i) lc rgb hues[i] pt shapes[i] ps (i == 1 ? 1.3 : 1) \
             title (count(pick(methods[i])) > 0 ? called[i] : "")
    unset output
}
