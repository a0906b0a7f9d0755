# The picture of the rigid impact in docs/verification.md, from two real runs:
#   apothem run data/scenes/impact-asymmetric.json
#   apothem run data/scenes/impact-asymmetric-area.json
#   gnuplot docs/images/impact.gnuplot
set terminal pngcairo size 1000,400 font 'DejaVu Sans,10' background 'white'
set output 'docs/images/impact.png'
set datafile separator ','
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
set xlabel 'time [s]'
distance = 'out/impact-asymmetric/history.csv'
area = 'out/impact-asymmetric-area/history.csv'
set multiplot layout 1,2 title 'Triangle falls apex on apex on a target with unequal legs (paper, case 2)'
set xrange [0:0.32]
set key default at graph 0.5,0.97 center top
set ylabel 'height of the mass centre [m]'
plot distance every ::1 using 1:3 with lines lw 5 lc rgb '#4477aa' title 'distance potential', \
     area every ::1 using 1:3 with lines lw 2 lc rgb '#ee6677' title 'area potential'
set key default left bottom
set ylabel 'horizontal drift [mm]'
plot distance every ::1 using 1:($2*1000) with lines lw 5 lc rgb '#4477aa' title 'distance potential: none', \
     area every ::1 using 1:($2*1000) with lines lw 2 lc rgb '#ee6677' title 'area potential'
unset multiplot
