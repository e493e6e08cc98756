# What does each thing cost that a scene may do without? Melt of 1000 chains of 100 bonds, one thread. Also given: level.
set style fill solid 0.7 noborder
set xlabel "time per bond (ns)"
set xrange [0:*] noextend
set yrange [*:*] reverse
set offsets 0, graph 0.16, 0.6, 0.6
set ytics scale 0
set xtics nomirror
unset key
set title sprintf("%s, 1000 chains of 100 bonds (dark: default)", level eq "acceleration" ? "Forces" : level eq "velocity" ? "Velocities" : level eq "position" ? "Positions" : "Metric")
here = sprintf("$7 != \"HOLONOMIC_ISA=avx512\" && $1 == \"%s\" && $3 == 1000 && $4 == 100 && $5 == 1 && $6 == \"holonomic\"", level)
pick = here . " && ($2 == \"melt\" || $7 ~ /^compensated/) && !seen[$7]++"
bars = rows(pick, "$7, $9, ($7 == \"default\" ? 1118481 : 29362)") . " | sort -t, -k2,2g"
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? "pngcairo noenhanced size 960,1000 font 'Sans,16'" : "svg noenhanced size 960,1000 font 'Sans,18' background 'white'")
    set output sprintf("%s/skips_%s.%s", out, level, kind)
    plot bars using (0):0:(0):2:($0 - 0.38):($0 + 0.38):3:yticlabels(1) with boxxyerror lc rgb variable, \
         bars using 2:0:(sprintf(" %.3g", $2)) with labels left font ",14"
    unset output
}
