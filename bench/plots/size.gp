# Does the time per bond depend on the length of the chain? One chain per call, one thread. Also given: level.
set logscale xy
set format x "10^{%T}"
set yrange [0.5:*]
set xlabel "bonds of the chain, N (one chain per call)"
set ylabel "time per bond (ns)"
set title sprintf("%s of coils%s", level eq "acceleration" ? "Forces" : level eq "velocity" ? "Velocities" : "Positions", level eq "position" ? "; iterative methods to 1e-12, LINCS of order 4" : "")
# A batch of 256 x 32 or the like is not a single chain; rows of one chain only.
pick(method, setting) = sprintf("$1 == \"%s\" && $2 == \"coil\" && $3 == 1 && $5 == 1 && $6 == \"%s\" && $7 ~ /%s/", level, method, setting)
sorted(c, what) = rows(c, what) . " | sort -t, -k1,1g"
wanted = level eq "position" ? "^(default|tolerance 1e-12|order 4 iterations 1)$" : "^(default|assembled|as printed|pattern reused|dense|literal)$"
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/size_%s.%s", out, level, kind)
    plot for [i=1:12] (count(pick(names[i], wanted)) > 0 ? sorted(pick(names[i], wanted), "$4, $9") : "< echo 1,NaN") using 1:2 \
             with linespoints lw width(i) lc rgb colours[i] pt marks[i] \
             title (count(pick(names[i], wanted)) > 0 ? titles[i] : ""), \
         (level eq "acceleration" ? sorted(pick("omega-recursion", "^unscaled scalar sweep$"), "$4, $9") : "< echo 1,NaN") using 1:2 \
             with linespoints lw 1.5 dt 3 lc rgb "#7f3f00" pt 6 title (level eq "acceleration" ? "scalar sweep" : ""), \
         sorted(pick("holonomic", "^default$"), "$4, $9 / $10") using 1:2 with lines lw 2 dt 2 lc rgb "#888888" \
             title "memory pass: the floor"
    unset output
}
