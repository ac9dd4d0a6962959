# gnuplot colour.gp
set terminal svg size 760,420 font "sans,12" background "white"
set output "colour.svg"
set grid
set logscale xy 10
set key left bottom
set xlabel "time over RGB's"
set ylabel "mean CIEDE2000 from 200 wavelengths"
set title "RGB, 4, 20 and the scene's own wavelengths"
plot for [i=0:2] "colour.dat" index i using 1:2 with linespoints lc i+1 pt 7 title columnheader(1), \
     for [i=0:2] "colour.dat" index i using 1:2:3 with labels offset 0,0.8 font "sans,10" notitle
