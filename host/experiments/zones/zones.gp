# gnuplot zones.gp
set terminal svg size 760,420 font "sans,12" background "white"
set grid
set key outside right
set logscale xy 10
set format y "10^{%T}"
set output "error_size.svg"
set xlabel "size of zones"
set ylabel "RMS of blocks over the mean"
set title "Error against paths over the size of zones (lines: Goral's room; dashes: closed)"
plot for [i=0:1] for [v=0:3] "error_size.dat" index i using 1:(column(v+2)) with linespoints pt (i == 0 ? 7 : 6) \
     dt i+1 lc v+1 title (i == 0 ? word("flat smooth direct gather", v+1) : "")
set output "error_rays.svg"
set xlabel "rays of the first round"
set title "Error against paths over rays (lines: Goral's room; dashes: closed)"
plot for [i=0:1] for [v=0:3] "error_rays.dat" index i using 1:(column(v+2)) with linespoints pt (i == 0 ? 7 : 6) \
     dt i+1 lc v+1 title (i == 0 ? word("flat smooth direct gather", v+1) : "")
set output "unsent_rays.svg"
unset logscale x
set key inside right top
set xlabel "rays"
set ylabel "unsent, of all power"
set title "Unsent power over rays"
array names[4] = ["Goral's room, all zones at a time", "the fullest zone", "closed, all", "closed, the fullest"]
plot for [i=0:3] "rounds.dat" index i using 2:3 with linespoints pt 7 ps (i % 2 == 0 ? 0.7 : 0) lc i+1 title names[i+1]
set output "unsent_rounds.svg"
set logscale x 10
set xlabel "rounds"
set title "Unsent power over rounds"
plot for [i=0:3] "rounds.dat" index i using 1:3 with linespoints pt 7 ps (i % 2 == 0 ? 0.7 : 0) lc i+1 title names[i+1]
set output "costs.svg"
set key outside right
set xlabel "CPU seconds, the light of zones included"
set ylabel "RMS of pixels over the mean"
set title "Noise over CPU seconds, Goral's room"
plot for [i=0:13] "costs.dat" index i using 1:2 with linespoints pt 7 lc i+1 title columnheader(1), 0.01 lc 0 title "asked"
set output "ranks.svg"
set key inside right top
set xlabel "nodes"
set ylabel "seconds"
set title "Time of the light of zones over nodes"
plot "ranks.dat" using 1:2 with points pt 7 ps 1.2 lc 1 title "measured", "" using 1:3 with lines lc 1 title "model, no net", \
     "" using 1:4 with lines lc 2 title "model, 1 Gbit/s", "" using 1:5 with lines lc 3 title "model, 8 Mbit/s"
