/* Measurements of error against time: kept, written as CSV, and summed up as tables of what a method needs to reach an
 * error and what error it reaches in a time. */
#ifndef TESTS_BENCH_ERROR_TABLE_H
#define TESTS_BENCH_ERROR_TABLE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef enum error_phase {
	PHASE_SCRATCH, /* from objects that exist: rows and a cold solve, or all paths */
	PHASE_MOVING,  /* a frame in which the mover went on */
	PHASE_COUNT
} error_phase;

/* Numbers that do not apply are NAN and empty in the CSV. */
typedef struct error_record {
	const char *scene, *method; /* must outlive the table */
	error_phase phase;
	double setting; /* row tolerance, paths a leaf, ... */
	double ms;
	double error, bias;                 /* of H, area-weighted, relative RMS and mean, % */
	double reference_noise;             /* %, already taken out of the error */
	double entries;                     /* per leaf */
	double solve_bound;                 /* reported: of the largest B, % */
	double stale_bound, sampling_error; /* reported likewise */
	uint32_t leaves;
} error_record;

enum { MAX_RECORDS = 1024 };

typedef struct error_table {
	error_record records[MAX_RECORDS];
	uint32_t count;
} error_table;

void error_table_add(error_table *t, const error_record *r);

bool error_table_write_csv(const error_table *t, const char *path);

/* Milliseconds to an error of at most `error` %, along straight lines in log-log between those measurements that none
 * beats in both; NAN: not reached. */
double error_table_time(const error_table *t, const char *scene, const char *method, error_phase phase, double error);

/* The error, %, after so many milliseconds, likewise; NAN: nothing is done by then. */
double error_table_error(const error_table *t, const char *scene, const char *method, error_phase phase, double ms);

/* Both as one markdown table for a scene and phase; a line a method. */
void error_table_print(const error_table *t, FILE *out, const char *scene, error_phase phase);

#endif
