# gnuplot depth.gp
set terminal svg size 760,420 font "sans,12" background "white"
set key right top
set grid
set logscale y
set format y "10^{%T}"
set yrange [1e-6:1]
set xrange [0:20]
set ylabel "RMS error"
set output "reflections.svg"
set xlabel "reflections on a branch, at most"
set title "What is missing behind a limit of reflections"
set arrow 1 from 4, graph 0 to 4, graph 1 nohead dt 2 lc 0
set arrow 2 from 5, graph 0 to 5, graph 1 nohead dt 2 lc 0
plot for [i=2:4] "reflections.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
set output "transmissions.svg"
set xlabel "transmissions on a branch, at most"
set title "What is missing behind a limit of transmissions"
set arrow 1 from 7, graph 0 to 7, graph 1 nohead dt 2 lc 0
set arrow 2 from 14, graph 0 to 14, graph 1 nohead dt 2 lc 0
plot for [i=3:4] "transmissions.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
