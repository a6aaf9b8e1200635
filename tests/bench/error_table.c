#include "error_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const phase_names[PHASE_COUNT] = {"scratch", "moving"};

void error_table_add(error_table *t, const error_record *r)
{
	if (t->count < MAX_RECORDS)
		t->records[t->count++] = *r;
}

static void print_number(FILE *out, double value)
{
	if (isfinite(value))
		fprintf(out, ",%.6g", value);
	else
		fprintf(out, ",");
}

bool error_table_write_csv(const error_table *t, const char *path)
{
	FILE *out = fopen(path, "w");
	if (!out)
		return false;
	fprintf(out,
		"scene,method,phase,setting,ms,error_percent,bias_percent,reference_noise_percent,entries_per_leaf,"
		"solve_bound_percent,stale_bound_percent,sampling_error_percent,leaves\n");
	for (uint32_t k = 0; k < t->count; k++) {
		const error_record *r = &t->records[k];
		fprintf(out, "%s,%s,%s,%.6g", r->scene, r->method, phase_names[r->phase], r->setting);
		const double numbers[] = {r->ms,      r->error,       r->bias,        r->reference_noise,
					  r->entries, r->solve_bound, r->stale_bound, r->sampling_error};
		for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
			print_number(out, numbers[n]);
		fprintf(out, ",%u\n", r->leaves);
	}
	return fclose(out) == 0;
}

/* ---- the lower envelope ---- */

typedef struct point {
	double ms, error;
} point;

typedef struct envelope {
	point points[MAX_RECORDS]; /* ms rises, error falls */
	uint32_t count;
} envelope;

static int by_time(const void *a, const void *b)
{
	const point *p = a, *q = b;
	return p->ms != q->ms ? (p->ms > q->ms) - (p->ms < q->ms) : (p->error > q->error) - (p->error < q->error);
}

/* Errors that drown in the reference's noise come out as 0, which has no logarithm. */
static const double LEAST_ERROR = 1e-3;

static void find_envelope(const error_table *t, const char *scene, const char *method, error_phase phase, envelope *e)
{
	e->count = 0;
	for (uint32_t k = 0; k < t->count; k++) {
		const error_record *r = &t->records[k];
		if (r->phase == phase && strcmp(r->scene, scene) == 0 && strcmp(r->method, method) == 0)
			e->points[e->count++] = (point){r->ms, fmax(r->error, LEAST_ERROR)};
	}
	qsort(e->points, e->count, sizeof *e->points, by_time);
	uint32_t kept = 0;
	for (uint32_t k = 0; k < e->count; k++)
		if (kept == 0 || e->points[k].error < e->points[kept - 1].error)
			e->points[kept++] = e->points[k];
	e->count = kept;
}

/* y at x on the line through (x0, y0) and (x1, y1), all logarithmic. */
static double interpolate(double x, double x0, double y0, double x1, double y1)
{
	return y0 * pow(y1 / y0, log(x / x0) / log(x1 / x0));
}

double error_table_time(const error_table *t, const char *scene, const char *method, error_phase phase, double error)
{
	static envelope e;
	find_envelope(t, scene, method, phase, &e);
	for (uint32_t k = 0; k < e.count; k++) {
		if (e.points[k].error > error)
			continue;
		return k == 0 ? e.points[0].ms
			      : interpolate(error, e.points[k - 1].error, e.points[k - 1].ms, e.points[k].error,
					    e.points[k].ms);
	}
	return NAN;
}

double error_table_error(const error_table *t, const char *scene, const char *method, error_phase phase, double ms)
{
	static envelope e;
	find_envelope(t, scene, method, phase, &e);
	for (uint32_t k = 0; k < e.count; k++) {
		if (e.points[k].ms <= ms)
			continue;
		return k == 0 ? NAN
			      : interpolate(ms, e.points[k - 1].ms, e.points[k - 1].error, e.points[k].ms,
					    e.points[k].error);
	}
	return e.count ? e.points[e.count - 1].error : NAN;
}

/* ---- markdown ---- */

static void print_cell(FILE *out, double value)
{
	if (isfinite(value))
		fprintf(out, " %.*f |", value < 10 ? 1 : 0, value);
	else
		fprintf(out, " - |");
}

static bool is_first_of_method(const error_table *t, uint32_t k, const char *scene, error_phase phase)
{
	for (uint32_t j = 0; j < k; j++) {
		const error_record *r = &t->records[j];
		if (r->phase == phase && strcmp(r->scene, scene) == 0 && strcmp(r->method, t->records[k].method) == 0)
			return false;
	}
	return t->records[k].phase == phase && strcmp(t->records[k].scene, scene) == 0;
}

void error_table_print(const error_table *t, FILE *out, const char *scene, error_phase phase)
{
	static const double errors[] = {5, 2, 1}, times[] = {1, 10, 100, 1000};
	fprintf(out, "| method | ms to 5 %% | to 2 %% | to 1 %% | error in 1 ms, %% | 10 ms | 100 ms | 1000 ms |\n"
		     "|---|---|---|---|---|---|---|---|\n");
	for (uint32_t k = 0; k < t->count; k++) {
		if (!is_first_of_method(t, k, scene, phase))
			continue;
		const char *method = t->records[k].method;
		fprintf(out, "| %s |", method);
		for (size_t n = 0; n < sizeof errors / sizeof *errors; n++)
			print_cell(out, error_table_time(t, scene, method, phase, errors[n]));
		for (size_t n = 0; n < sizeof times / sizeof *times; n++)
			print_cell(out, error_table_error(t, scene, method, phase, times[n]));
		fprintf(out, "\n");
	}
	fprintf(out, "\n");
}
