# Which tolerance does a simulation at constant energy need? Textbook RATTLE against the library.
set logscale xy
set format xy "10^{%T}"
set xlabel "tolerance of RATTLE's sweeps" offset 0,0.6
set ylabel "drift of the energy / (kinetic energy x unit of time)"
set title "Energy drift of a melt of 64 chains of 31 bonds, WCA beads, dt = 0.003"
set xrange [*:*] reverse
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/energy_drift.%s", out, kind)
    exact = real(system(sprintf("awk -F, '$7 == \"energy drift to rounding\" { print $8 }' '%s'", results)))
    plot rows("$6 == \"rattle\" && $7 ~ /^energy drift/", "substr($7, 24), $8") using 1:2 \
             with linespoints lw 1.5 lc rgb colours[4] pt marks[4] title "rattle", \
         exact with lines lw 3 lc rgb colours[1] title "holonomic, to rounding"
    unset output
}
