# Molecules of any topology beside the library's own chains of as many bonds and the fastest method that is as accurate.
# Given: level.
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.8 noborder
set boxwidth 1
set logscale y
set ylabel "time per bond (ns)"
set xtics rotate by -35 font ",10" scale 0
set key inside top left vertical
set rmargin 12
set title sprintf("%s, one thread", level eq "acceleration" ? "Forces (lambda and G)" : level eq "velocity" ? "Velocities" : "Positions, with velocities and lambda") font ",11"
other = level eq "position" ? "sparse-newton,tolerance 1e-12" : "sparse-ldl,pattern reused"
# A line per scene: its name, and the times of the three.
scenes = sprintf("< awk -F, '$1 == \"%s\" && $5 == 1 && $2 !~ /^(coil|melt|tetrahedral|straight5|light_joints|fixed_ends)$/ { k = $2 \" \" $3 \"x\" $4; t[k \",\" $6 \",\" $7] = $9; if (!n[k]++) order[++m] = k } END { for (i = 1; i <= m; ++i) { k = order[i]; print k, t[k \",holonomic,default\"] + 0, (t[k \",holonomic,chains instead\"] ? t[k \",holonomic,chains instead\"] : \"NaN\"), t[k \",%s\"] + 0 } }' OFS=, '%s'", level, other, results)
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? "pngcairo noenhanced size 1200,640 font 'Sans,12'" : "svg noenhanced size 1200,640 font 'Sans,14' background 'white'")
    set output sprintf("%s/molecules_%s.%s", out, level, kind)
    plot scenes using 2:xtic(1) lc rgb colours[1] title "holonomic", \
         scenes using 3 lc rgb "#999999" title "holonomic, chains of as many bonds", \
         scenes using 4 lc rgb colours[2] title (level eq "position" ? "sparse Newton, 1e-12" : "sparse L D L^T")
    unset output
}
