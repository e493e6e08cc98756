# gnuplot -e "data='sweep.txt'; picture='condition.png'" condition_sweep.gp
# Each point has the bound of its own number of bonds: 64, but 1 to 16384 for straight chains.
set terminal pngcairo enhanced size 1000,640 font "Sans,15"
set output picture
set logscale xy
set format "10^{%T}"
set border lc rgb "#555555"
set grid lc rgb "#dddddd"
set xlabel "condition number of Z (scaled to ones on its diagonal, infinity norm)"
set ylabel "largest error of {/Symbol l} / (eps x componentwise scale)"
set key top left Left reverse samplen 1.5 box lc rgb "#dddddd" opaque
set yrange [0.01:1e22]
plot data using 2:5 with points pt 1 ps 1.2 lc rgb "#888888" title "LAPACK dptsv", \
     data using 2:4 with points pt 2 ps 1.2 lc rgb "#d55e00" title "recursion as printed (Eq. 17)", \
     data using ((strcol(1) eq "straight") ? $2 : 1/0):6 smooth unique with lines dt 2 lw 2 lc rgb "#009e73" \
         title "bound 16 + {/Symbol \326}N, straight chains of N bonds", \
     data using ((strcol(1) eq "straight") ? 1/0 : $2):6 smooth unique with lines dt 3 lw 2 lc rgb "#0072b2" \
         title "bound for N = 64, all others", \
     data using ((strcol(1) eq "straight") ? $2 : 1/0):3 with points pt 7 ps 1.3 lc rgb "#009e73" title "holonomic, straight, N = 1 to 16384", \
     data using ((strcol(1) eq "light-joints") ? $2 : 1/0):3 with points pt 5 ps 1.2 lc rgb "#0072b2" title "holonomic, light joints", \
     data using ((strcol(1) eq "taut") ? $2 : 1/0):3 with points pt 9 ps 1.4 lc rgb "#111111" title "holonomic, taut between fixed ends"
