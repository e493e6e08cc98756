# One large molecule: does the time per bond depend on its size? Given: level.
set logscale x
set format x "10^{%T}"
set xlabel "bonds of the molecule"
set ylabel "time per bond (ns)"
set yrange [0:*]
set xrange [8e3:1.3e6]
other = level eq "position" ? "sparse-newton" : "sparse-ldl"
setting = level eq "position" ? "tolerance 1e-12" : "pattern reused"
set title sprintf("One large molecule, %s, one thread", level eq "position" ? "positions" : "forces")
array molecules[3] = ["arms", "random_tree", "protein"]
array hues[3] = ["#111111", "#0072b2", "#d55e00"]
pick(problem, method, setting) = sprintf("$1 == \"%s\" && $2 == \"%s\" && $3 == 1 && $5 == 1 && $6 == \"%s\" && $7 == \"%s\"", level, problem, method, setting)
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/large_%s.%s", out, level, kind)
    plot for [i=1:3] rows(pick(molecules[i], "holonomic", "default"), "$4, $9") using 1:2 with linespoints lw 3 lc rgb hues[i] pt 7 title "holonomic, ".scene(molecules[i]), \
         for [i=1:3] rows(pick(molecules[i], other, setting), "$4, $9") using 1:2 with linespoints lw 1.5 dt 2 lc rgb hues[i] pt 5 title (level eq "position" ? "sparse Newton, " : "sparse L D L^T, ").scene(molecules[i]), \
         rows(pick("arms", "holonomic", "chains instead"), "$4, $9") using 1:2 with linespoints lw 1.5 dt 3 lc rgb "#888888" pt 9 title "holonomic, one chain"
    unset output
}
