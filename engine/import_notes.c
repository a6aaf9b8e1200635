/* What a reader tells: the one reason why a file is refused, and what it left out or mended, once a kind. */
#include "output.h"
#include "import_build.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *import_copy_name(const char *name, const char *fallback, uint32_t number)
{
	size_t size = (name && name[0] ? strlen(name) : strlen(fallback) + 10) + 1;
	char *copy = malloc(size);
	if (!copy)
		return NULL;
	if (name && name[0])
		memcpy(copy, name, size);
	else
		snprintf(copy, size, "%s%u", fallback, number);
	engine_output_one_line(copy);
	return copy;
}

bool import_fail(import_loader *loader, const char *format, ...)
{
	char text[512];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	snprintf(loader->message, loader->message_size, "%s: %s", loader->path, text);
	if (loader->message_size)
		engine_output_one_line(loader->message);
	return false;
}

/* The kind of this text, made where it is new; NULL: one too many, or no memory for any. */
static import_kind *kind_of(import_loader *loader, const char *text)
{
	if (!loader->kinds)
		loader->kinds = calloc(IMPORT_MAX_KINDS, sizeof *loader->kinds);
	if (!loader->kinds)
		return NULL;
	for (uint32_t k = 0; k < loader->kind_count; k++) {
		if (strcmp(loader->kinds[k].text, text) == 0)
			return &loader->kinds[k];
	}
	if (loader->kind_count == IMPORT_MAX_KINDS)
		return NULL;
	import_kind *kind = &loader->kinds[loader->kind_count++];
	strcpy(kind->text, text);
	return kind;
}

__attribute__((format(printf, 4, 0))) static void note(import_loader *loader, uint32_t count, const char *subject,
						       const char *format, va_list arguments)
{
	char text[sizeof loader->kinds->text];
	vsnprintf(text, sizeof text, format, arguments);
	import_kind *kind = count > 0 ? kind_of(loader, text) : NULL;
	if (!kind)
		return;
	if (kind->count == 0 && subject)
		snprintf(kind->first, sizeof kind->first, "%s", subject);
	kind->count += count;
}

void import_note(import_loader *loader, const char *subject, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	note(loader, 1, subject, format, arguments);
	va_end(arguments);
}

void import_note_many(import_loader *loader, uint32_t count, const char *subject, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	note(loader, count, subject, format, arguments);
	va_end(arguments);
}

/* "textures are not read (3, first: "wall")" */
static size_t write_kind(const import_kind *kind, char *text, size_t size)
{
	const char *open = kind->first[0] ? "\"" : "", *before = kind->first[0] ? ", first: " : "";
	int length;
	if (kind->count == 1 && !kind->first[0])
		length = snprintf(text, size, "%s", kind->text);
	else if (kind->count == 1)
		length = snprintf(text, size, "%s (\"%s\")", kind->text, kind->first);
	else
		length =
		    snprintf(text, size, "%s (%u%s%s%s%s)", kind->text, kind->count, before, open, kind->first, open);
	return length < 0 ? 0 : (size_t)length;
}

void import_write_warning(import_loader *loader)
{
	char *warning = loader->scene->warning;
	size_t used = 0, size = sizeof loader->scene->warning;
	for (uint32_t k = 0; k < loader->kind_count && used + 4 < size; k++) {
		if (k > 0)
			used += (size_t)snprintf(warning + used, size - used, "; ");
		used += write_kind(&loader->kinds[k], warning + used, size - used);
	}
	engine_output_one_line(warning);
}
