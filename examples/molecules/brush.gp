# A bottle brush, seen from the side, with the mean tensions of its bonds as colours:
#     gnuplot -e "input='brush.dat'; picture='brush.png'" brush.gp
set terminal pngcairo size 1100,420 font ",12" background "white"
set output picture
unset border
unset tics
unset key
set cbtics
set size ratio -1
set margins 1,12,1,1
set cblabel "mean tension, kT/a"
set palette defined (0 "#2c5f9e", 1 "#5aa0c8", 2 "#e6c05a", 3 "#c03a2b")
plot input using 1:2:($4-$1):($5-$2):7 with vectors nohead linewidth 5 linecolor palette
