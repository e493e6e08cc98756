# Which tolerance does a simulation at constant energy need? Textbook RATTLE against the library.
set logscale xy
set format xy "10^{%T}"
set xlabel "tolerance of RATTLE's sweeps"
set ylabel "energy drift / (kinetic energy x time)"
set title "Melt of 64 chains of 31 bonds, WCA beads, dt = 0.003"
set xrange [*:*] reverse
# Runs that differ by rounding alone - the library's, and sweeps to 1e-8 and better - differ by this: what one run can't resolve.
noise = real(system(sprintf("awk -F, '$7 ~ /^energy drift (to rounding|tolerance 1e-(08|10|12))/ && $8 > n { n = $8 } END { print n }' '%s'", results)))
exact = real(system(sprintf("awk -F, '$7 == \"energy drift to rounding\" { print $8 }' '%s'", results)))
least = 1e-8
set yrange [least:*]
set bars small
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/energy_drift.%s", out, kind)
    plot noise with filledcurves y=least lc rgb "#dddddd" title "not resolved by a run", \
         rows("$6 == \"rattle\" && $7 ~ /^energy drift/", "substr($7, 24), $8") using 1:2:($2 - noise > least ? $2 - noise : least):($2 + noise) \
             with yerrorlines lw 1.5 lc rgb colours[4] pt marks[4] ps 1.5 title titles[4], \
         exact with lines lw 3 lc rgb colours[1] title "holonomic, to rounding"
    unset output
}
