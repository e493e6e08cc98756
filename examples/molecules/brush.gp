# A bottle brush, seen from the side, with the mean tensions of its bonds as colours:
#     gnuplot -e "input='brush.dat'; picture='brush.png'" brush.gp
set terminal pngcairo enhanced size 1100,420 font "Sans,15" background "white"
set output picture
unset border
unset tics
unset key
set cbtics
set size ratio -1
set lmargin at screen 0.01
set rmargin at screen 0.87
set bmargin at screen 0.02
set tmargin at screen 0.98
set colorbox user origin 0.89, 0.12 size 0.018, 0.76
set cblabel "mean tension of the bond (kT/a)" offset 1.5
set cbrange [0:*]
set palette defined (0 "#2c5f9e", 1 "#5aa0c8", 2 "#e6c05a", 3 "#c03a2b")
plot input using 1:2:($4-$1):($5-$2):7 with vectors nohead linewidth 5 linecolor palette
