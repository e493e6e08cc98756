# What does each thing cost that a scene may do without? Melt of 1000 chains of 100 bonds, one thread. Also given: level.
set style fill solid 0.7
set ylabel "time per bond / ns"
set xtics rotate by 35 right font ",10"
set yrange [0:*]
set bmargin 9
unset key
set boxwidth 0.7
set title sprintf("What a scene saves, or pays: %s level, 1000 chains of 100 bonds (dark: the whole work)", level)
pick = sprintf("$1 == \"%s\" && $2 == \"melt\" && $3 == 1000 && $4 == 100 && $5 == 1 && $6 == \"holonomic\" && !seen[$7]++", level)
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? png : svg)
    set output sprintf("%s/skips_%s.%s", out, level, kind)
    plot rows(pick, "$7, $9, ($7 == \"default\" ? 1118481 : 29362)") . " | sort -t, -k2,2g" \
             using 0:2:3:xticlabels(1) with boxes lc rgb variable
    unset output
}
