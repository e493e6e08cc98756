# A gel under strain: stress against stretch, beside a phantom network's:
#     gnuplot -e "input='gel.dat'; picture='gel.png'" gel.gp
set terminal pngcairo enhanced size 800,520 font "Sans,14" background "white"
set output picture
set border 3 linecolor "#555555"
set tics nomirror out
set xlabel "stretch of the box along z"
set ylabel "s_{zz} - (s_{xx} + s_{yy})/2   (kT per volume of a strand)"
set key left top
set grid linecolor "#e0e0e0"
plot x**2 - 1/x title "phantom network of coils" with lines linewidth 2 linecolor "#2c5f9e", \
     input using 1:2:3 title "rigid bonds" with yerrorbars pointtype 7 linecolor "#c03a2b"
