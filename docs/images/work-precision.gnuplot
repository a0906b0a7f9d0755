# The picture in docs/verification.md, from
#   apothem benchmark --filter ^work/ --repeat 1 -o out/precision
#   gnuplot docs/images/work-precision.gnuplot
set terminal pngcairo size 1200,700 font 'DejaVu Sans,10' background 'white'
set output 'docs/images/work-precision.png'
set datafile separator ','
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
set logscale xy
set format y '10^{%L}'
set key bottom left
# The number at the end of a name, time in ms, error.
rows(case, kind) = sprintf("< awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { if ($i == \"median [ns]\") t = i; if ($i == \"error\") e = i } } sub(\"^work/%s/%s/\", \"\", $1) { print $1 \",\" 1e-6 * $t \",\" $e }' out/precision/benchmark.csv", case, kind)
set multiplot layout 2,3 title 'Energy error against computing time; the numbers are the step in thousandths of the stability limit'
titles = 'impact gas pack beam discs'
do for [case in titles] {
  set title case eq 'impact' ? 'a square falls, worst of 64 landings' : case eq 'gas' ? 'gas of 16 polygons, 300 impacts' : \
            case eq 'pack' ? '100 quadrilaterals come to rest' : case eq 'beam' ? 'beam hit by a block, Q4' : 'oblique discs, Q4'
  set xlabel 'time [ms]'
  set ylabel case eq 'gas' ? 'rms error per impact / energy of a body' : case eq 'pack' ? 'error / dissipated energy' : 'largest error / kinetic energy'
  plot rows(case, 'plain') using 2:3 with linespoints pt 7 lw 2 lc rgb '#ee6677' title 'velocity Verlet', \
       rows(case, 'plain') using 2:3:1 with labels offset 1.2,.7 font ',8' tc rgb '#ee6677' notitle, \
       rows(case, 'corrected') using 2:3 with linespoints pt 7 lw 2 lc rgb '#4477aa' title 'onsets corrected', \
       rows(case, 'corrected') using 2:3:1 with labels offset 1.2,.7 font ',8' tc rgb '#4477aa' notitle
}
unset multiplot
