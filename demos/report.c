#define _POSIX_C_SOURCE 200809L
#include "report.h"

#include "output.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* After so many frames the table is about those; the file goes on. */
enum { MAX_REMEMBERED = 100000 };

const char *report_outcome_name(gi_outcome outcome)
{
	switch (outcome) {
	case GI_OUTCOME_NOT_FINITE:
		return "not finite";
	case GI_OUTCOME_TRUNCATED:
		return "truncated";
	case GI_OUTCOME_NOT_RUN:
		return "not run";
	case GI_OUTCOME_CONVERGED:
		return "converged";
	case GI_OUTCOME_SWEEPS:
		return "sweeps spent";
	case GI_OUTCOME_AT_REST:
		return "at rest";
	case GI_OUTCOME_ROUNDING:
		return "rounding";
	}
	return "unknown";
}

const char *report_method_name(gi_method method)
{
	return method == GI_METHOD_CHEBYSHEV ? "Chebyshev" : "Jacobi";
}

/* ---- the file ------------------------------------------------------------------------------------------------------
 */

static void write_header(FILE *file)
{
	fputs("frame,time_s,outcome,objects,leaves,nodes,entries,links,new_entries,flagged_entries,dirty_entries,dirty_"
	      "rows,rays,"
	      "sweeps,jacobi_sweeps,method,residual_w_per_m2,contraction,amplification,solve_bound_w_per_m2,solve_"
	      "relative,"
	      "rounding_bound_w_per_m2,radiosity_max_w_per_m2,"
	      "waiting_rows,waiting_entries,stale_bound_w_per_m2,stale_relative,"
	      "sampling_estimate_w_per_m2,sampling_relative,sampling_rays,"
	      "dispatches,"
	      "uploaded_bytes,gpu_bytes",
	      file);
	for (int k = 0; k < GI_PASS_COUNT; k++)
		fprintf(file, ",%s_gpu_ms", gi_pass_name((gi_pass)k));
	fputs(",update_cpu_ms,update_wall_ms,frame_wall_ms,budget_ms,frames_per_second\n", file);
}

static double frames_per_second(const report_frame *f)
{
	return f->shown_ms > 0 ? 1e3 / f->shown_ms : 0;
}

static void write_frame(FILE *file, const report_frame *f)
{
	const gi_report *g = &f->gi;
	fprintf(file, "%u,%.6f,%s,%u,%u,%u,%llu,%llu", f->number, f->time_s, report_outcome_name(g->outcome),
		g->objects, g->leaves, g->nodes, (unsigned long long)g->entries, (unsigned long long)g->links);
	fprintf(file, ",%llu,%llu,%llu,%llu,%llu", (unsigned long long)g->new_entries,
		(unsigned long long)g->flagged_entries, (unsigned long long)g->dirty_entries,
		(unsigned long long)g->dirty_rows, (unsigned long long)g->rays);
	fprintf(file, ",%u,%u,%s,%.9g,%.9g,%.9g", g->sweeps, g->jacobi_sweeps, report_method_name(g->method),
		(double)g->residual, (double)g->contraction, (double)g->amplification);
	fprintf(file, ",%.9g,%.9g,%.9g,%.9g", (double)g->solve_bound, (double)g->solve_relative,
		(double)g->rounding_bound, (double)g->radiosity_max);
	fprintf(file, ",%llu,%llu,%.9g,%.9g", (unsigned long long)g->waiting_rows,
		(unsigned long long)g->waiting_entries, (double)g->stale_bound, (double)g->stale_relative);
	fprintf(file, ",%.9g,%.9g,%llu", (double)g->sampling_estimate, (double)g->sampling_relative,
		(unsigned long long)g->sampling_rays);
	fprintf(file, ",%u,%llu,%llu", g->dispatches, (unsigned long long)g->uploaded_bytes,
		(unsigned long long)g->gpu_bytes);
	for (int k = 0; k < GI_PASS_COUNT; k++)
		fprintf(file, ",%.3f", (double)g->pass_ms[k]);
	fprintf(file, ",%.3f,%.3f,%.3f", (double)g->update_ms, f->update_ms, f->frame_ms);
	fprintf(file, ",%.3f,%.3f\n", f->budget_ms, frames_per_second(f));
}

static bool cannot_write(const report *r, char *message, size_t message_size)
{
	snprintf(message, message_size, "cannot write %s: %s", r->path, strerror(errno ? errno : EIO));
	return false;
}

static bool is_plain(FILE *file)
{
	struct stat status;
	return fstat(fileno(file), &status) == 0 && S_ISREG(status.st_mode);
}

static bool close_file(report *r)
{
	const bool written = fclose(r->file) == 0;
	engine_output_whole(r->path);
	r->file = NULL;
	return written;
}

bool report_open(report *r, const char *path, char *message, size_t message_size)
{
	*r = (report){.path = path};
	if (!path)
		return true;
	errno = 0;
	r->file = fopen(path, "w");
	if (!r->file)
		return cannot_write(r, message, message_size);
	if (is_plain(r->file))
		engine_output_half(path); /* until it has a line */
	write_header(r->file);
	if (fflush(r->file) == 0) {
		r->whole = ftell(r->file);
		return true;
	}
	cannot_write(r, message, message_size);
	close_file(r);
	return false;
}

bool report_close(report *r, char *message, size_t message_size)
{
	errno = 0;
	const bool written = !r->file || close_file(r);
	return written || cannot_write(r, message, message_size);
}

void report_abandon(report *r)
{
	if (!r->file)
		return;
	const bool plain = is_plain(r->file);
	close_file(r);
	if (plain && !r->lines)
		unlink(r->path);
}

/* ---- the table -----------------------------------------------------------------------------------------------------
 */

static void to_columns(const report_frame *f, float columns[REPORT_COLUMNS])
{
	columns[REPORT_UPDATE_MS] = (float)f->update_ms;
	columns[REPORT_FRAME_MS] = (float)f->frame_ms;
	columns[REPORT_FPS] = (float)frames_per_second(f);
	columns[REPORT_BUDGET_MS] = (float)f->budget_ms;
	columns[REPORT_SWEEPS] = (float)f->gi.sweeps;
	columns[REPORT_DIRTY_PERCENT] = f->gi.entries ? 100.0f * (float)f->gi.dirty_entries / (float)f->gi.entries : 0;
	columns[REPORT_RAYS] = (float)f->gi.rays;
	columns[REPORT_RESIDUAL] = f->gi.residual;
	columns[REPORT_AMPLIFICATION] = f->gi.amplification;
	columns[REPORT_BOUND] = f->gi.solve_bound;
	columns[REPORT_ROUNDING] = f->gi.rounding_bound;
	columns[REPORT_WAITING_PERCENT] = f->gi.leaves ? 100.0f * (float)f->gi.waiting_rows / (float)f->gi.leaves : 0;
	columns[REPORT_STALE_BOUND] = f->gi.stale_bound;
	columns[REPORT_ESTIMATE] = f->gi.sampling_estimate;
	columns[REPORT_ESTIMATE_PERCENT] = 100 * f->gi.sampling_relative;
	memcpy(columns + REPORT_PASS_MS, f->gi.pass_ms, sizeof f->gi.pass_ms);
}

/* A lack of memory costs rows of the table and nothing else. */
static bool make_room(report *r)
{
	if (r->count < r->capacity)
		return true;
	if (r->capacity >= MAX_REMEMBERED)
		return false;
	const uint32_t capacity = r->capacity ? 2 * r->capacity : 256;
	void *values = realloc(r->values, capacity * sizeof *r->values);
	if (!values)
		return false;
	r->values = values;
	r->capacity = capacity;
	return true;
}

/* The end of a file that cannot be written on: what is left in the stream is tried once more, then cut off. */
static void drop_half_line(report *r)
{
	const int fd = is_plain(r->file) ? dup(fileno(r->file)) : -1;
	close_file(r);
	if (fd < 0)
		return;
	if (!r->lines)
		unlink(r->path);
	else
		(void)!ftruncate(fd, r->whole); /* the error is told already */
	close(fd);
}

bool report_add(report *r, const report_frame *frame, char *message, size_t message_size)
{
	if (frame->number == 0) {
		r->first = frame->gi;
		r->first_ms = frame->update_ms;
	}
	r->last = frame->gi;
	r->outcomes[frame->gi.outcome - GI_OUTCOME_NOT_FINITE]++;
	if (make_room(r))
		to_columns(frame, r->values[r->count++]);
	errno = 0;
	if (!r->file)
		return true;
	write_frame(r->file, frame);
	if (fflush(r->file) == 0) {
		engine_output_whole(r->path);
		r->lines++;
		r->whole = ftell(r->file);
		return true;
	}
	cannot_write(r, message, message_size);
	drop_half_line(r);
	return false;
}

static int compare(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* A row of the table; the first frame, which builds everything, is not in it unless it is the only one. */
static void print_row(const report *r, FILE *to, const char *name, int column, int digits)
{
	const uint32_t skip = r->count > 1, count = r->count - skip;
	float *sorted = malloc(count * sizeof *sorted);
	if (!sorted)
		return;
	for (uint32_t k = 0; k < count; k++)
		sorted[k] = r->values[k + skip][column];
	qsort(sorted, count, sizeof *sorted, compare);
	const double median = 0.5 * ((double)sorted[(count - 1) / 2] + (double)sorted[count / 2]);
	const double least = (double)sorted[0], most = (double)sorted[count - 1];
	if (digits < 0)
		fprintf(to, "  %-22s %12.3g %12.3g %12.3g\n", name, median, least, most);
	else
		fprintf(to, "  %-22s %12.*f %12.*f %12.*f\n", name, digits, median, digits, least, digits, most);
	free(sorted);
}

static void print_passes(const report *r, FILE *to)
{
	for (int k = 0; k < GI_PASS_COUNT; k++) {
		char name[32];
		float most = 0;
		for (uint32_t f = 0; f < r->count; f++)
			most = fmaxf(most, r->values[f][REPORT_PASS_MS + k]);
		snprintf(name, sizeof name, "  %s, GPU ms", gi_pass_name((gi_pass)k));
		if (most > 0)
			print_row(r, to, name, REPORT_PASS_MS + k, 2);
	}
}

static void print_outcomes(const report *r, FILE *to)
{
	const char *separator = "  outcomes               ";
	for (int k = 0; k < 8; k++)
		if (r->outcomes[k]) {
			fprintf(to, "%s%s %u", separator, report_outcome_name((gi_outcome)(k + GI_OUTCOME_NOT_FINITE)),
				r->outcomes[k]);
			separator = ", ";
		}
	fputc('\n', to);
}

static void print_sizes(const report *r, FILE *to)
{
	const gi_report *g = &r->last;
	fprintf(to, "  %-22s %u leaves of %u objects, %llu entries, %.0f per leaf, %.1f MiB on the GPU\n", "scene",
		g->leaves, g->objects, (unsigned long long)g->entries, g->leaves ? (double)g->entries / g->leaves : 0,
		(double)g->gpu_bytes / (1 << 20));
	fprintf(to, "  %-22s every row built in %.1f ms, %u sweeps; its picture %.2f s after the start\n",
		"first frame", r->first_ms, r->first.sweeps, 1e-3 * r->start_ms);
}

static bool is_anywhere(const report *r, report_column column)
{
	for (uint32_t f = 0; f < r->count; f++)
		if (r->values[f][column] > 0)
			return true;
	return false;
}

void report_print(const report *r, FILE *to)
{
	if (!r->count)
		return;
	print_sizes(r, to);
	print_outcomes(r, to);
	fprintf(to, "  %-22s %12s %12s %12s\n", r->count > 1 ? "frames after the first" : "this frame", "median",
		"least", "most");
	print_row(r, to, "update, ms", REPORT_UPDATE_MS, 1);
	print_row(r, to, "update and picture, ms", REPORT_FRAME_MS, 1);
	print_row(r, to, "frames a second", REPORT_FPS, 1);
	if (is_anywhere(r, REPORT_BUDGET_MS))
		print_row(r, to, "budget, ms", REPORT_BUDGET_MS, 1);
	print_passes(r, to);
	print_row(r, to, "dirty entries, %", REPORT_DIRTY_PERCENT, 2);
	print_row(r, to, "rays", REPORT_RAYS, 0);
	print_row(r, to, "sweeps", REPORT_SWEEPS, 0);
	print_row(r, to, "residual, W/m2", REPORT_RESIDUAL, -1);
	print_row(r, to, "amplification", REPORT_AMPLIFICATION, 1);
	print_row(r, to, "certified bound, W/m2", REPORT_BOUND, -1);
	print_row(r, to, "  of it rounding, W/m2", REPORT_ROUNDING, -1);
	if (is_anywhere(r, REPORT_WAITING_PERCENT)) {
		print_row(r, to, "waiting rows, %", REPORT_WAITING_PERCENT, 1);
		print_row(r, to, "stale bound, W/m2", REPORT_STALE_BOUND, -1);
	}
	if (r->first.sampling_rays) {
		print_row(r, to, "estimated error, W/m2", REPORT_ESTIMATE, -1);
		print_row(r, to, "estimated error, %", REPORT_ESTIMATE_PERCENT, 2);
	}
}

double report_estimate_percent(const report *r)
{
	double sum = 0;
	for (uint32_t f = 0; f < r->count; f++)
		sum += pow((double)r->values[f][REPORT_ESTIMATE_PERCENT], 2);
	return r->count ? sqrt(sum / r->count) : 0;
}

void report_free(report *r)
{
	free(r->values);
	r->values = NULL;
	r->count = r->capacity = 0;
}
