# Figure 6: frames a second against triangles, and the time to radiosity's error. `folder` is set; reads figure6.csv there.
#
# Colours are Okabe and Ito's, told apart with any eye; marks differ too.
csv = folder . '/figure6.csv'
set datafile separator ','
set datafile missing NaN # lines go on over other methods' rows
set key autotitle columnhead
set style line 1 lc rgb '#0072B2' lw 2.5 pt 7 ps 1.2
set style line 2 lc rgb '#D55E00' lw 2.5 pt 9 ps 1.3
set style line 3 lc rgb '#009E73' lw 2.5 pt 5 ps 1.2
set style line 11 lc rgb '#0072B2' lw 1.5 pt 6 ps 1.2 dt 2
set style line 12 lc rgb '#D55E00' lw 1.5 pt 8 ps 1.3 dt 2
set style line 13 lc rgb '#009E73' lw 1.5 pt 4 ps 1.2 dt 2
set style line 20 lc rgb '#d0d0d0' lw 0.7
set grid ls 20
set logscale xy
set xlabel 'triangles of the Buddha'
set format x '%.0s%c'
set xrange [700:400000]
pick(method, motion, column) = strcol(3) eq method && strcol(4) eq motion ? column : NaN
do for [kind in 'png svg'] {
	if (kind eq 'png') {
		set terminal pngcairo size 1400, 640 font 'sans,13'
	} else {
		set terminal svg size 1400, 640 font 'sans,13' background '#ffffff'
	}
	set output folder . '/figure6.' . kind
	set multiplot layout 1, 2
	set key outside below reverse Left maxrows 3
	set title 'Frames a second'
	set ylabel 'frames a second'
	set format y '%g'
	plot \
		csv using 1:(pick('radiosity', 'moving', $5)) with linespoints ls 1 title 'radiosity, moving', \
		csv using 1:(pick('radiosity', 'rest', $5)) with linespoints ls 11 title 'radiosity, at rest', \
		csv using 1:(pick('realtime', 'moving', $5)) with linespoints ls 2 title 'real-time ray tracing, moving', \
		csv using 1:(pick('realtime', 'rest', $5)) with linespoints ls 12 title 'real-time ray tracing, at rest', \
		csv using 1:(pick('offline', 'moving', $5)) with linespoints ls 3 title 'off-line ray tracing'
	set title 'Time to a picture as good as radiosity''s'
	set ylabel 'ms (not drawn: not reached)'
	plot \
		csv using 1:(pick('radiosity', 'moving', $17)) with linespoints ls 1 title 'radiosity, moving', \
		csv using 1:(pick('realtime', 'moving', $17)) with linespoints ls 2 title 'real-time ray tracing, moving', \
		csv using 1:(pick('realtime', 'rest', $17)) with linespoints ls 12 title 'real-time ray tracing, at rest', \
		csv using 1:(pick('offline', 'moving', $17)) with linespoints ls 3 title 'off-line ray tracing'
	unset multiplot
	unset output
}
