# gnuplot lighting.gp
set terminal svg size 760,420 font "sans,12" background "white"
set output "error.svg"
set key right top
set grid
set logscale xy 10
set xlabel "rays"
set ylabel "RMS error, linear"
set title "Errors over rays in the diffuse test room"
plot "error.dat" index 0 using 1:2 with linespoints pt 7 lc 1 title "the thesis's directions: cones, one set", \
     "" index 1 using 1:2 with linespoints pt 5 lc 2 title "flux, sets turned"
