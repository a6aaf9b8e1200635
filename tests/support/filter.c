/* Linked into every test program: RELUME_TEST names the tests of it that run, with * and ? for any text and letter. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

__attribute__((constructor)) static void choose_tests(void)
{
	const char *wanted = getenv("RELUME_TEST");
	if (wanted)
		cmocka_set_test_filter(wanted);
}
