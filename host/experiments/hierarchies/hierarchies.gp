# gnuplot hierarchies.gp
set terminal svg size 760,420 font "sans,12" background "white"
set key right top
set grid y
set style data histograms
set style fill solid 0.8
set logscale y
set ylabel "per ray"
set xtics rotate by -30
set output "tests.svg"
set title "Primitives that a ray tests"
plot for [i=1:3] "hierarchies.dat" using (column(i+1)):xtic(1) title sprintf("Image %d", i)
set output "times.svg"
set title "Nanoseconds that a ray takes"
plot for [i=1:3] "hierarchies.dat" using (column(i+4)):xtic(1) title sprintf("Image %d", i)
