/* The text of OBJ, MTL and PLY files as lines, words and numbers; parsed in place, each byte once. */
#ifndef ENGINE_IMPORT_TEXT_H
#define ENGINE_IMPORT_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct import_text {
	char *next, *end;       /* what is still to be read; a zero byte stands at end */
	uint32_t line;          /* the number of the line that was read last, from 1 on */
	uint32_t continuations; /* lines that it went on over */
} import_text;

/* The text of `size` bytes with a zero byte behind them; a byte order mark is skipped. */
import_text import_text_of(uint8_t *bytes, size_t size);

/* The next line without its end (LF, CR LF or CR), or NULL behind the last one. A backslash at the end of a line that
 * is no comment (#) makes the next line a part of it. Zero bytes in the line become blanks.
 */
char *import_next_line(import_text *text);

/* The next word of a line, cut out of it with a zero byte; NULL at the end. */
char *import_next_word(char **rest);

/* What is left of a line, without the blanks around it. */
char *import_rest_of_line(char *rest);

/* Reads the number at *cursor, which blanks may precede and a blank or the end must follow, and moves *cursor behind
 * it. Decimal, with or without digits before or behind the point, with or without an exponent; nan and inf are read as
 * such. False with *cursor at what is none.
 */
bool import_read_number(char **cursor, double *value);

/* How many significant digits the number has that import_read_number() moved the cursor over, from `before` to `after`;
 * 0 without a point: whole numbers are rarely rounded ones.
 */
uint32_t import_digits(const char *before, const char *after);

/* Skips blanks and ends of lines, counting these in text->line. False at the end of the text. */
bool import_skip_blanks(import_text *text);

/* Moves text->next behind the word that begins there. */
void import_skip_word(import_text *text);

#endif
