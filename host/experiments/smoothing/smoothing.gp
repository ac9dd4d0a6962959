# gnuplot smoothing.gp
set terminal svg size 760,420 font "sans,12" background "white"
set grid
set key outside right
set output "jumps.svg"
set xlabel "frame"
set ylabel "largest change of a point's light"
set title "A ball that turns about the line of sight, the light at the eye: no change is the truth"
plot for [i=0:5] "jumps.dat" index i using 1:2 with lines lw 2 title columnheader(1)
set output "profile.svg"
set xlabel "across the picture"
set ylabel "light"
set title "Along a line of the picture"
plot for [i=0:5] "profile.dat" index i using 1:2 with lines title columnheader(1)
set output "slope.svg"
set yrange [-8:8]
set ylabel "slope of the light, per picture's width"
set title "Its slope: where it jumps the eye sees Mach bands"
plot for [i=1:5] "profile.dat" index i using 1:3 with lines title columnheader(1)
