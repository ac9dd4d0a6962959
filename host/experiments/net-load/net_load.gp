# gnuplot net_load.gp
set terminal svg size 760,420 font "sans,12" background "white"
set key right top
set grid
set output "knee.svg"
set logscale xy 2
set xrange [3.5:36]
set yrange [3:20]
set xlabel "processors"
set ylabel "frame, seconds"
set title "A frame on the virtual cluster, on nets that 12 processors fill"
plot "knee.dat" index 0 using 1:2 with points pt 7 lc 1 title "pixel wire, measured", \
     "" index 0 using 1:3 with lines lc 1 title "model, bytes on the links", \
     "" index 1 using 1:2 with points pt 5 lc 2 title "block wire on a third of the rate, measured", \
     "" index 1 using 1:3 with lines lc 2 dt 2 title "model"
set output "use.svg"
unset logscale
set xrange [*:*]
set yrange [0:1.6]
set xlabel "seconds since the first ray"
set ylabel "share of the net's rate"
set title "The net's use over time, pixel wire"
plot "use.dat" index 0 using 1:2 with steps lc 1 title "8 processors", \
     "" index 1 using 1:2 with steps lc 2 title "18 processors", \
     "" index 2 using 1:2 with steps lc 3 title "32 processors"
set output "beyond.svg"
set logscale xy 10
set xrange [10:20000]
set yrange [10:20000]
set key left top
set xlabel "processors"
set ylabel "speed-up"
set title "Simulated, with the numbers of 1985: 0.04 s a pixel, 8 Mbit/s, 1024 x 1024"
plot "beyond.dat" index 0 using 1:2 with linespoints lc 1 title "pixel wire, 9 bytes", \
     "" index 1 using 1:2 with linespoints lc 2 title "block wire, 3 bytes", \
     "" index 2 using 1:2 with linespoints lc 3 title "compressed, 0.59 bytes", \
     "+" using (4444):(4444) every ::0::0 with points pt 3 ps 2 lc 0 title "the thesis: 4,444"
set output "rays.svg"
unset logscale
set xrange [*:*]
set yrange [0:100]
set key outside right
set style data histograms
set style histogram rowstacked title offset 0,-1.5
set style fill solid 0.8 border -1
set boxwidth 0.6
set bmargin 5
set xtics rotate by -25
set xlabel ""
set ylabel "share, %"
set title "Left: rays by kinds; right: eye rays by the types of Figure 4.6"
plot newhistogram "kinds", "rays.dat" using 2:xtic(1) title "primary", "" using 3 title "shadow", \
     "" using 4 title "reflected", "" using 5 title "transmitted", \
     newhistogram "types" at 5, "rays.dat" using 7:xtic(1) title "type 1", "" using 8 title "type 2", "" using 9 title "type 3"
