# Rigid bodies: what a trajectory of a given error takes, by the library and by quaternions. results: bodies.csv.
set logscale xy
set format x "%g"
set format y "10^{%T}"
set xlabel "constraint and rotation work, us per body and unit of time"
set ylabel "error of the positions after 4 units of time"
set title "Rigid bodies: atoms with projections, and NO\\_SQUISH" enhanced
set key below maxrows 4
array bodies[4] = ["CO2", "benzene", "C60", "free top"]
array shades[4] = ["#d55e00", "#009e73", "#0072b2", "#cc79a7"]
of(body, method) = rows(sprintf("$1 == \"%s\" && $2 == \"%s\"", body, method), "$6 / $3 / 1000, $4")
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/bodies.%s", out, kind)
    plot for [i = 1:4] of(bodies[i], "holonomic") using 1:2 with linespoints lw 3 pt 7 lc rgb shades[i] title bodies[i] . ", holonomic", \
         for [i = 1:4] of(bodies[i], "no-squish") using 1:2 with linespoints lw 1.5 dt 2 pt 6 lc rgb shades[i] title bodies[i] . ", quaternions"
    unset output
}
