# gnuplot bounding_volumes.gp
set terminal svg size 900,440 font "sans,12" background "white"
set key outside right
set grid y
set yrange [0:*]
set style data histograms
set style fill solid 0.8
set output "totals.svg"
set title "Time relative to C here, and beside each in 1984"
set xtics rotate by -30
plot for [i=2:9] "totals.dat" using i:xtic(1) title columnheader(i)
set output "phases.svg"
set title "Phases of C and SHZ, relative to C's time"
set style histogram rowstacked
plot for [i=2:6] "phases.dat" using i:xtic(1) title columnheader(i)
