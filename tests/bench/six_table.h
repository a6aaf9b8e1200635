/* Figure 6 as files. */
#ifndef TESTS_BENCH_SIX_TABLE_H
#define TESTS_BENCH_SIX_TABLE_H

#include "six.h"

enum { SIX_MOST_ROWS = 64 };

typedef struct six_table {
	six_row rows[SIX_MOST_ROWS];
	uint32_t count;
} six_table;

void six_table_add(six_table *table, const six_row *row);

/* False with one line in message. What does not exist is left empty. */
bool six_table_write_csv(const six_table *table, const char *path, char *message, size_t message_size);

/* The table in Markdown, after lines of what it was measured on. */
bool six_table_write_markdown(const six_table *table, const char *path, const char *heading, char *message,
			      size_t message_size);

/* Draws FOLDER/figure6.csv by gnuplot as FOLDER/figure6.png and .svg. False where that cannot be run. */
bool six_table_plot(const char *folder);

#endif
