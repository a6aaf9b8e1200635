/* Which files a scene may open: those of its own folder, and only files. */
#define _XOPEN_SOURCE 700 /* mkdtemp, mkfifo, symlink */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/import_path.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[64];
static char message[256];

/* root/outside.bin, root/scene/{scene.gltf,inside.bin,empty,pipe,in,out,sub/deep.bin} */
static const char *path_of(const char *name)
{
	static char path[256];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static void write_text(const char *name, const char *text)
{
	FILE *file = fopen(path_of(name), "wb");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static int make_folder(void **state)
{
	(void)state;
	strcpy(folder, "/tmp/relume-path-XXXXXX");
	if (!mkdtemp(folder) || mkdir(path_of("scene"), 0700) || mkdir(path_of("scene/sub"), 0700) ||
	    mkfifo(path_of("scene/pipe"), 0600) || symlink("sub/deep.bin", path_of("scene/in")) ||
	    symlink("../outside.bin", path_of("scene/out")))
		return -1;
	write_text("outside.bin", "secret");
	write_text("scene/inside.bin", "inside");
	write_text("scene/sub/deep.bin", "deep");
	write_text("scene/empty", "");
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	static const char *const names[] = {"scene/pipe",         "scene/in",    "scene/out",       "outside.bin",
					    "scene/sub/deep.bin", "scene/empty", "scene/inside.bin"};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		unlink(path_of(names[i]));
	rmdir(path_of("scene/sub"));
	rmdir(path_of("scene"));
	return rmdir(folder);
}

static FILE *open_below(const char *name)
{
	message[0] = '\0';
	return import_open_below(path_of("scene/scene.gltf"), name, message, sizeof message);
}

static void check_opens(const char *name, const char *content)
{
	size_t size;
	uint8_t *bytes = import_read_all(open_below(name), 100, &size, message, sizeof message);
	if (!bytes)
		fail_msg("%s: %s", name, message);
	assert_string_equal((const char *)bytes, content);
	assert_int_equal(size, strlen(content));
	free(bytes);
}

static void check_refused(const char *name, const char *words)
{
	FILE *file = open_below(name);
	assert_null(file);
	if (!strstr(message, words))
		fail_msg("%s: \"%s\" does not say \"%s\"", name, message, words);
}

static void files_of_the_folder_are_opened(void **state)
{
	(void)state;
	check_opens("inside.bin", "inside");
	check_opens("./inside.bin", "inside");
	check_opens("sub/deep.bin", "deep");
	check_opens("sub/../inside.bin", "inside");
	check_opens("in", "deep");
	check_opens("sub\\deep.bin", "deep"); /* as Windows writes it */
}

static void files_outside_are_not(void **state)
{
	(void)state;
	check_refused("../outside.bin", "outside");
	check_refused("sub/../../outside.bin", "outside");
	check_refused("../../../../../../../../etc/passwd", "outside");
	check_refused("out", "outside");
	check_refused("/etc/passwd", "absolute");
	check_refused("..\\outside.bin", "outside");
	check_refused("http://example.org/inside.bin", "elsewhere");
	check_refused("file:///etc/passwd", "elsewhere");
	check_refused("..", "outside");
	check_refused("absent.bin", "cannot be opened");
}

/* A FIFO without a writer would wait for ever. */
static void only_files_are_opened(void **state)
{
	(void)state;
	check_refused("pipe", "not a file");
	check_refused("sub", "a folder");
	check_refused(".", "outside"); /* the folder itself is not below it */
	assert_null(import_open(path_of("scene/pipe"), message, sizeof message));
	assert_null(import_open("/dev/zero", message, sizeof message));
	assert_non_null(strstr(message, "device"));
}

static void files_are_read_up_to_a_limit(void **state)
{
	(void)state;
	size_t size;
	assert_null(import_read_all(open_below("inside.bin"), 5, &size, message, sizeof message));
	assert_non_null(strstr(message, "6 bytes"));
	assert_null(import_read_all(open_below("empty"), 5, &size, message, sizeof message));
	assert_non_null(strstr(message, "empty"));
	assert_null(import_read_all(open_below("absent"), 5, &size, message, sizeof message));
	assert_non_null(strstr(message, "cannot be opened"));
	assert_int_equal(size, 0);
}

static void escapes_are_turned_back(void **state)
{
	(void)state;
	char name[] = "a%20b%2F%2e%2e/100%%4", zero[] = "a%00b";
	assert_true(import_unescape(name));
	assert_string_equal(name, "a b/../100%%4");
	assert_false(import_unescape(zero));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(files_of_the_folder_are_opened), cmocka_unit_test(files_outside_are_not),
	    cmocka_unit_test(only_files_are_opened),          cmocka_unit_test(files_are_read_up_to_a_limit),
	    cmocka_unit_test(escapes_are_turned_back),
	};
	return cmocka_run_group_tests_name("import_path", tests, make_folder, remove_folder);
}
