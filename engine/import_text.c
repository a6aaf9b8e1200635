#include "import_text.h"

#include <stdlib.h>
#include <string.h>

import_text import_text_of(uint8_t *bytes, size_t size)
{
	size_t mark = size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
	return (import_text){.next = (char *)bytes + mark, .end = (char *)bytes + size};
}

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static bool ends_line(char c)
{
	return c == '\n' || c == '\r';
}

/* The first end of a line from `from` on, or the end of the text. */
static char *find_end_of_line(char *from, const char *end)
{
	for (; from < end && !ends_line(*from); from++) {
		if (*from == '\0')
			*from = ' ';
	}
	return from;
}

/* Behind the end of a line, which has one or two characters. */
static char *behind_end_of_line(char *at, const char *end)
{
	bool two = at[0] == '\r' && at + 1 < end && at[1] == '\n';
	return at < end ? at + (two ? 2 : 1) : at;
}

char *import_next_line(import_text *text)
{
	if (text->next >= text->end)
		return NULL;
	char *line = text->next;
	text->line += 1 + text->continuations;
	text->continuations = 0;
	bool is_comment = line[strspn(line, " \t")] == '#';
	char *at = find_end_of_line(line, text->end);
	while (!is_comment && at > line && at[-1] == '\\') {
		char *next = behind_end_of_line(at, text->end);
		memset(at - 1, ' ', (size_t)(next - at) + 1);
		text->continuations += next > at;
		at = find_end_of_line(next, text->end);
	}
	text->next = behind_end_of_line(at, text->end);
	*at = '\0';
	return line;
}

char *import_next_word(char **rest)
{
	char *word = *rest;
	while (is_blank(*word))
		word++;
	char *end = word;
	while (*end && !is_blank(*end))
		end++;
	*rest = *end ? end + 1 : end;
	*end = '\0';
	return *word ? word : NULL;
}

char *import_rest_of_line(char *rest)
{
	while (is_blank(*rest))
		rest++;
	size_t length = strlen(rest);
	while (length > 0 && is_blank(rest[length - 1]))
		length--;
	rest[length] = '\0';
	return rest;
}

/* strtod() also reads hexadecimal numbers, which are none in these formats. */
static bool is_hexadecimal(const char *at)
{
	at += *at == '+' || *at == '-';
	return at[0] == '0' && (at[1] | 32) == 'x';
}

bool import_read_number(char **cursor, double *value)
{
	char *at = *cursor, *end;
	while (is_blank(*at))
		at++;
	*cursor = at;
	if (*at == '\0' || ends_line(*at) || is_hexadecimal(at))
		return false;
	*value = strtod(at, &end);
	if (end == at || (*end && !is_blank(*end) && !ends_line(*end)))
		return false;
	*cursor = end;
	return true;
}

uint32_t import_digits(const char *before, const char *after)
{
	uint32_t digits = 0;
	bool point = false;
	for (; before < after && (*before | 32) != 'e'; before++) {
		point = point || *before == '.';
		digits += *before >= '0' && *before <= '9' && (digits > 0 || *before > '0');
	}
	return point ? digits : 0;
}

bool import_skip_blanks(import_text *text)
{
	while (text->next < text->end && (is_blank(*text->next) || ends_line(*text->next))) {
		bool ended = ends_line(*text->next);
		text->next = ended ? behind_end_of_line(text->next, text->end) : text->next + 1;
		text->line += ended;
	}
	return text->next < text->end;
}

void import_skip_word(import_text *text)
{
	while (text->next < text->end && !is_blank(*text->next) && !ends_line(*text->next))
		text->next++;
}
