# gnuplot -e "data='sweep.txt'; picture='condition.png'" condition_sweep.gp
set terminal pngcairo size 900,560 font "sans,11"
set output picture
set logscale xy
set format "10^{%T}"
set xlabel "condition number of Z~ (infinity norm)"
set ylabel "worst error of lambda / (eps x componentwise scale)"
set key top left
set yrange [0.01:]
plot data using ((strcol(1) eq "straight") ? $2 : 1/0):3 with points pt 7 lc rgb "#0060ad" title "holonomic, straight chains", \
     data using ((strcol(1) eq "light-joints") ? $2 : 1/0):3 with points pt 5 lc rgb "#0060ad" title "holonomic, light joints", \
     data using ((strcol(1) eq "taut") ? $2 : 1/0):3 with points pt 9 lc rgb "#0060ad" title "holonomic, taut between fixed ends", \
     data using 2:4 with points pt 2 lc rgb "#dd181f" title "recursion as printed (Eq. 17)", \
     data using 2:5 with points pt 1 lc rgb "#555555" title "LAPACK dptsv", \
     24 with lines dt 2 lc rgb "#0060ad" title "bound, 16 + sqrt(N) at N = 64"
