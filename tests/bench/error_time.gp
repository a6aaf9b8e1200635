# Error against time, one picture a scene: from scratch on the left, per moving frame on the right.
#
#     gnuplot -e "csv='out/error-time.csv'; folder='out/pictures'; scene='cornell'" tests/bench/error_time.gp
#
# Colours are Okabe and Ito's, told apart with any eye; marks differ too.
set style line 1 lc rgb '#0072B2' lw 2.5 pt 7 ps 1.1
set style line 2 lc rgb '#56B4E9' lw 2.0 pt 6 ps 1.1
set style line 3 lc rgb '#D55E00' lw 2.0 pt 9 ps 1.2
set style line 4 lc rgb '#009E73' lw 2.0 pt 5 ps 1.0
set style line 5 lc rgb '#CC79A7' lw 2.0 pt 13 ps 1.3
set style line 6 lc rgb '#E69F00' lw 2.0 pt 11 ps 1.2
methods = '"engine" "engine rebuilt" "Embree paths" "shader paths" "engine budget" "engine error"'
rows(method, phase) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" && $3 == \"%s\" && $6 > 0 { print $5, $6 }' '%s'", \
	scene, method, phase, csv)
# A method without measurements has no line and no place in the legend.
has(method, phase) = int(system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"%s\" && $3 == \"%s\" && $6 > 0' '%s' | wc -l", \
	scene, method, phase, csv))) > 0
set logscale xy
set format x '%g'
set format y '%g'
set ytics (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200)
set xlabel 'time, ms'
set grid xtics ytics lc rgb '#d8d8d8'
set border lc rgb '#606060'
set key top right samplen 2 spacing 1.1 opaque box lc rgb '#c0c0c0'
do for [kind in 'png svg'] {
	if (kind eq 'png') {
		set terminal pngcairo size 1120,460 font 'sans,11' background rgb 'white'
	} else {
		set terminal svg size 1120,460 font 'sans,12' background rgb 'white'
	}
	set output sprintf('%s/error-time-%s.%s', folder, scene, kind)
	stats sprintf("< awk -F, '$1 == \"%s\" && $6 > 0 { print $5, $6 }' '%s'", scene, csv) using 1:2 nooutput name 'ALL'
	set xrange [0.7 * ALL_min_x : 1.5 * ALL_max_x]
	set yrange [0.7 * ALL_min_y : 1.8 * ALL_max_y]
	set multiplot layout 1,2
	do for [phase in 'scratch moving'] {
		set title sprintf('%s: %s', scene, phase eq 'scratch' ? 'from scratch' : 'per frame, while it moves')
		set ylabel phase eq 'scratch' ? 'error of the irradiance, %' : ''
		present = ''
		do for [k = 1:words(methods)] {
			if (has(word(methods, k), phase)) {
				present = present.sprintf(' %d', k)
			}
		}
		plot for [k in present] rows(word(methods, int(k)), phase) using 1:2 with linespoints ls int(k) title word(methods, int(k))
	}
	unset multiplot
	set output
}
