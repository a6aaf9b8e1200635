#include "six_table.h"

#include "output.h"

#include <math.h>
#include <stdio.h>

static const char plot_script[] =
#include "shaders/figure_six.gp.inc"
    ;

void six_table_add(six_table *table, const six_row *row)
{
	if (table->count < SIX_MOST_ROWS)
		table->rows[table->count++] = *row;
}

static void print_number(FILE *out, double x)
{
	fprintf(out, isnan(x) ? "," : ",%.6g", x);
}

static void print_rows(FILE *out, const six_table *table)
{
	fprintf(out, "triangles,mesh_kb,method,motion,fps,ms");
	for (int k = 0; k < SIX_PARTS; k++)
		fprintf(out, ",ms_%s", six_part_names[k]);
	fprintf(out, ",rel_mse,ssim,equal_error_ms\n");
	for (uint32_t k = 0; k < table->count; k++) {
		const six_row *r = &table->rows[k];
		fprintf(out, "%u,%.1f,%s,%s", r->triangles, r->mesh_kb, six_method_names[r->method],
			six_motion_names[r->motion]);
		print_number(out, 1000 / r->ms);
		print_number(out, r->ms);
		for (int part = 0; part < SIX_PARTS; part++)
			print_number(out, r->parts[part]);
		print_number(out, r->relative_mse);
		print_number(out, r->ssim);
		print_number(out, r->equal_error_ms);
		fprintf(out, "\n");
	}
}

bool six_table_write_csv(const six_table *table, const char *path, char *message, size_t message_size)
{
	engine_output file;
	if (!engine_output_open(&file, path, message, message_size))
		return false;
	print_rows(file.file, table);
	return engine_output_close(&file, !ferror(file.file), message, message_size);
}

/* ---- Markdown ---- */

static void print_cell(FILE *out, const char *format, double x)
{
	if (isnan(x))
		fprintf(out, " - |");
	else
		fprintf(out, format, x);
}

static void print_figures(FILE *out, const six_table *table)
{
	fprintf(out,
		"| triangles | KB | method | motion | frames a second | ms | relative MSE | SSIM | ms to the error of "
		"radiosity |\n|---|---|---|---|---|---|---|---|---|\n");
	for (uint32_t k = 0; k < table->count; k++) {
		const six_row *r = &table->rows[k];
		fprintf(out, "| %u | %.0f | %s | %s |", r->triangles, r->mesh_kb, six_method_names[r->method],
			six_motion_names[r->motion]);
		print_cell(out, " %.3g |", 1000 / r->ms);
		print_cell(out, " %.1f |", r->ms);
		print_cell(out, " %.2e |", r->relative_mse);
		print_cell(out, " %.4f |", r->ssim);
		print_cell(out, " %.0f |", r->equal_error_ms);
		fprintf(out, "\n");
	}
}

static void print_parts(FILE *out, const six_table *table)
{
	fprintf(
	    out,
	    "\nWhat a frame's time goes to, ms (build: once, before the first):\n\n| triangles | method | motion |");
	for (int k = 0; k < SIX_PARTS; k++)
		fprintf(out, " %s |", six_part_names[k]);
	fprintf(out, "\n|---|---|---|---|---|---|---|---|---|---|---|\n");
	for (uint32_t k = 0; k < table->count; k++) {
		const six_row *r = &table->rows[k];
		fprintf(out, "| %u | %s | %s |", r->triangles, six_method_names[r->method],
			six_motion_names[r->motion]);
		for (int part = 0; part < SIX_PARTS; part++)
			print_cell(out, " %.1f |", r->parts[part]);
		fprintf(out, "\n");
	}
}

bool six_table_write_markdown(const six_table *table, const char *path, const char *heading, char *message,
			      size_t message_size)
{
	engine_output file;
	if (!engine_output_open(&file, path, message, message_size))
		return false;
	fprintf(file.file, "%s\n", heading);
	print_figures(file.file, table);
	print_parts(file.file, table);
	return engine_output_close(&file, !ferror(file.file), message, message_size);
}

/* ---- plot ---- */

/* A name within gnuplot's single quotes. */
static void print_quoted(FILE *out, const char *text)
{
	fputc('\'', out);
	for (; *text; text++) {
		if (*text == '\'')
			fputc('\'', out);
		fputc(*text, out);
	}
	fputc('\'', out);
}

bool six_table_plot(const char *folder)
{
	FILE *gnuplot = popen("gnuplot", "w");
	if (!gnuplot)
		return false;
	fprintf(gnuplot, "folder = ");
	print_quoted(gnuplot, folder);
	fprintf(gnuplot, "\n%s", plot_script);
	return pclose(gnuplot) == 0;
}
