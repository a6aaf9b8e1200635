# Distance to the solution by frame, a panel for each rho.
#
#     gnuplot -e "csv='out/stiff-motion.csv'; folder='out/pictures'" tests/bench/stiff_motion.gp
#
# Colours are Okabe and Ito's, told apart with any eye; dashes differ too.
set style line 1 lc rgb '#0072B2' lw 3.0 dt 1
set style line 2 lc rgb '#56B4E9' lw 2.0 dt 2
set style line 3 lc rgb '#D55E00' lw 2.5 dt 1
set style line 4 lc rgb '#E69F00' lw 2.0 dt 4
set style line 5 lc rgb '#909090' lw 1.2 dt 3
rhos = system(sprintf("awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' '%s'", csv))
rested = int(system(sprintf("awk -F, '$3 == 0 { print $2; exit }' '%s'", csv)))
last = int(system(sprintf("awk -F, 'END { print $2 }' '%s'", csv)))
curve(rho, solver, start, column) = sprintf( \
	"< awk -F, '$1 == \"%s\" && $4 == \"%s\" && $5 == \"%s\" { print $2, $%d }' '%s'", rho, solver, start, column, csv)
set logscale y
set yrange [1e-7 : 10]
set ytics ('10^{-5} %%' 1e-7, '10^{-4} %%' 1e-6, '0.001 %%' 1e-5, '0.01 %%' 1e-4, '0.1 %%' 1e-3, '1 %%' 1e-2, '10 %%' 1e-1, \
	'100 %%' 1, '1000 %%' 10)
set xrange [0 : last]
set grid xtics ytics lc rgb '#d8d8d8'
set border lc rgb '#606060'
set object 1 rectangle from rested, graph 0 to last, graph 1 fc rgb '#f0f0f0' fs solid noborder behind
set label 1 'at rest' at rested, graph 0.95 offset 0.6, 0 tc rgb '#606060'
do for [kind in 'png svg'] {
	if (kind eq 'png') {
		set terminal pngcairo size 1120,860 font 'sans,11' background rgb 'white'
	} else {
		set terminal svg size 1120,860 font 'sans,12' background rgb 'white'
	}
	set output sprintf('%s/stiff-motion.%s', folder, kind)
	set multiplot layout 2,2
	do for [k = 1:words(rhos)] {
		rho = word(rhos, k)
		set title sprintf('rho %s', rho)
		set xlabel k > 2 ? 'frame' : ''
		set ylabel k % 2 ? 'off the solution, of the largest light reflected' : ''
		if (k == words(rhos)) {
			set key bottom left reverse Left samplen 3 spacing 1.1 opaque box lc rgb '#c0c0c0'
		} else {
			unset key
		}
		plot curve(rho, 'library', 'warm', 8) with lines ls 5 title 'library, warm: certified bound', \
			curve(rho, 'Jacobi', 'cold', 7) with lines ls 4 title 'Jacobi, cold', \
			curve(rho, 'Jacobi', 'warm', 7) with lines ls 3 title 'Jacobi, warm', \
			curve(rho, 'library', 'cold', 7) with lines ls 2 title 'library, cold', \
			curve(rho, 'library', 'warm', 7) with lines ls 1 title 'library, warm'
	}
	unset multiplot
	set output
}
