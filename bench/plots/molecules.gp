# Molecules of any topology beside the library's own chains of as many bonds and the fastest method that is as accurate.
# Given: level.
set logscale x
set format x "%g"
set xlabel "time per bond (ns)"
set yrange [*:*] reverse
set offsets 0, 0, 0.8, 0.8
set ytics scale 0
set grid y
set title sprintf("%s, one thread", level eq "acceleration" ? "Forces (lambda and G)" : level eq "velocity" ? "Velocities" : "Positions, with velocities and lambda")
other = level eq "position" ? "sparse-newton,tolerance 1e-12" : "sparse-ldl,pattern reused"
# A line per scene: its name, and the times of the three; one that is missing is no point.
scenes = sprintf("< awk -F, '$1 == \"%s\" && $5 == 1 && $2 !~ /^(coil|melt|tetrahedral|straight5|light_joints|fixed_ends)$/ { name = $2; gsub(/_/, \" \", name); k = name \", \" $3 \" x \" $4; gsub(/,/, \":\", k); t[k \",\" $6 \",\" $7] = $9; if (!n[k]++) order[++m] = k } function of(x) { return x ? x : \"NaN\" } END { for (i = 1; i <= m; ++i) { k = order[i]; print k, of(t[k \",holonomic,default\"]), of(t[k \",holonomic,chains instead\"]), of(t[k \",%s\"]) } }' OFS=, '%s'", level, other, results)
do for [kind in "png svg"] {
    eval "set terminal " . (kind eq "png" ? "pngcairo noenhanced size 960,1000 font 'Sans,16'" : "svg noenhanced size 960,1000 font 'Sans,18' background 'white'")
    set output sprintf("%s/molecules_%s.%s", out, level, kind)
    plot scenes using 2:0:yticlabels(1) with points lc rgb colours[1] pt marks[1] ps 1.5 title "holonomic", \
         scenes using 3:0 with points lc rgb "#888888" pt 9 ps 1.5 title "chains of as many bonds", \
         scenes using 4:0 with points lc rgb colours[2] pt marks[2] ps 1.3 title (level eq "position" ? "sparse Newton, 1e-12" : "sparse L D L^T")
    unset output
}
