# What does each thing cost that a scene may do without? Melt of 1000 chains of 100 bonds, one thread. Also given: level.
set style fill solid 0.7 noborder
set xlabel "time per bond (ns)"
set xrange [0:*]
set yrange [*:*] reverse
set offsets 0, 0, 0.6, 0.6
set ytics font ",11" scale 0
set xtics nomirror
unset key
set lmargin 34
set title sprintf("%s, 1000 chains of 100 bonds: what a scene saves or pays (dark: the whole work)", level) font ",11"
here = sprintf("$1 == \"%s\" && $3 == 1000 && $4 == 100 && $5 == 1 && $6 == \"holonomic\"", level)
pick = here . " && ($2 == \"melt\" || $7 ~ /^compensated/) && !seen[$7]++"
bars = rows(pick, "$7, $9, ($7 == \"default\" ? 1118481 : 29362)") . " | sort -t, -k2,2g"
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? "pngcairo noenhanced size 960,800 font 'Sans,12'" : "svg noenhanced size 960,800 font 'Sans,14' background 'white'")
    set output sprintf("%s/skips_%s.%s", out, level, kind)
    plot bars using (0):0:(0):2:($0 - 0.38):($0 + 0.38):3:yticlabels(1) with boxxyerror lc rgb variable, \
         bars using 2:0:(sprintf(" %.3g", $2)) with labels left font ",10"
    unset output
}
