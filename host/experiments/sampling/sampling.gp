# gnuplot sampling.gp
set terminal svg size 560,400 font "sans,12" background "white"
set key left bottom
set grid
set logscale x 2
set logscale y 10
set format y "10^{%T}"
set xlabel "samples per pixel"
set ylabel "RMS error"
set output "errors_edges_upright.svg"
set title "edges_upright" noenhanced
plot for [i=2:8] "edges_upright.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
set output "errors_edges_slanted.svg"
set title "edges_slanted" noenhanced
plot for [i=2:8] "edges_slanted.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
set output "errors_textures.svg"
set title "textures" noenhanced
plot for [i=2:8] "textures.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
set output "errors_soft_shadow.svg"
set title "soft_shadow" noenhanced
plot for [i=2:8] "soft_shadow.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
set output "errors_gloss.svg"
set title "gloss" noenhanced
plot for [i=2:8] "gloss.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
set output "errors_depth_of_field.svg"
set title "depth_of_field" noenhanced
plot for [i=2:8] "depth_of_field.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
