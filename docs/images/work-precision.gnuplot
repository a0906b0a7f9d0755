# The picture in docs/verification.md, from
#   apothem_benchmark --benchmark_filter=work/ --benchmark_out_format=csv --benchmark_out=out/work.csv
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
rows(case, kind) = sprintf("< grep '^\"work/%s/%s/' out/work.csv | sed 's|^\"[^\"]*/%s/\\([0-9]*\\)[^\"]*\"|\\1|'", case, kind, kind)
set multiplot layout 2,3 title 'Energy error against computing time; the numbers are the step in thousandths of the stability limit'
titles = 'impact gas pack beam discs'
do for [case in titles] {
  set title case eq 'impact' ? 'a square falls, worst of 64 landings' : case eq 'gas' ? 'gas of 16 polygons, 300 impacts' : \
            case eq 'pack' ? '100 quadrilaterals come to rest' : case eq 'beam' ? 'beam hit by a block, Q4' : 'oblique discs, Q4'
  set xlabel 'time [ms]'
  set ylabel case eq 'gas' ? 'rms error per impact / energy of a body' : case eq 'pack' ? 'error / dissipated energy' : 'largest error / kinetic energy'
  plot rows(case, 'plain') using 4:11 with linespoints pt 7 lw 2 lc rgb '#ee6677' title 'velocity Verlet', \
       rows(case, 'plain') using 4:11:1 with labels offset 1.2,.7 font ',8' tc rgb '#ee6677' notitle, \
       rows(case, 'corrected') using 4:11 with linespoints pt 7 lw 2 lc rgb '#4477aa' title 'onsets corrected', \
       rows(case, 'corrected') using 4:11:1 with labels offset 1.2,.7 font ',8' tc rgb '#4477aa' notitle
}
unset multiplot
