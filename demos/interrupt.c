#define _POSIX_C_SOURCE 200809L
#include "interrupt.h"

#include "output.h"

#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { GRACE_S = 1 };

static const int signals[] = {SIGINT, SIGTERM, SIGHUP};

static volatile sig_atomic_t came;

static char last_words[128];

/* As all that follows it, safe in a handler. */
static void cut_off(void)
{
	engine_output_drop_halves();
	(void)!write(STDERR_FILENO, last_words, strlen(last_words));
	signal(came, SIG_DFL);
	raise(came);
}

static void time_is_up(int number)
{
	(void)number;
	cut_off();
}

static void note(int number)
{
	const bool again = came != 0;
	came = number;
	if (again)
		cut_off();
	alarm(GRACE_S);
}

static void handle(int number, void (*handler)(int), int flags)
{
	struct sigaction action = {.sa_handler = handler, .sa_flags = flags};
	sigaction(number, &action, NULL);
}

void interrupt_begin(const char *program)
{
	/* Over the line that shows progress, see progress.h. */
	snprintf(last_words, sizeof last_words, "%s%.80s: stopped before the frame was done\n",
		 isatty(STDERR_FILENO) ? "\r\033[K" : "", program);
	handle(SIGALRM, time_is_up, 0);
	for (size_t k = 0; k < sizeof signals / sizeof *signals; k++) {
		struct sigaction before;
		if (sigaction(signals[k], NULL, &before) == 0 && before.sa_handler == SIG_DFL)
			handle(signals[k], note, SA_RESTART | SA_NODEFER);
	}
}

bool interrupt_came(void)
{
	if (came)
		alarm(0);
	return came != 0;
}

void interrupt_end(void)
{
	if (!came)
		return;
	signal(came, SIG_DFL);
	raise(came);
}
