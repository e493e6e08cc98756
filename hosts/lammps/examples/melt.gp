# melt.dat: time, energy per bead, error of bonds, rate of bonds
set terminal pngcairo size 900,600
set output 'melt.png'
set multiplot layout 2,1
stats 'melt.dat' every ::0::0 using 2 nooutput
first = STATS_min
set xlabel 'time'
set ylabel 'energy per bead, change'
set format y '%.0e'
set grid
plot 'melt.dat' using 1:($2-first) with lines notitle
set ylabel 'largest error'
set logscale y
set yrange [1e-17:1e-12]
plot 'melt.dat' using 1:3 with lines title '|d^2 - a^2| / a^2', '' using 1:4 with lines title '|d.v|'
