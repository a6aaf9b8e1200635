#define _POSIX_C_SOURCE 200809L
#include "interrupt.h"

#include <signal.h>
#include <stddef.h>

static const int signals[] = {SIGINT, SIGTERM, SIGHUP};

static volatile sig_atomic_t came;

static void note(int number)
{
	came = number;
}

void interrupt_begin(void)
{
	struct sigaction before, action = {.sa_handler = note, .sa_flags = (int)SA_RESETHAND | SA_RESTART};
	for (size_t k = 0; k < sizeof signals / sizeof *signals; k++)
		if (sigaction(signals[k], NULL, &before) == 0 && before.sa_handler == SIG_DFL)
			sigaction(signals[k], &action, NULL);
}

bool interrupt_came(void)
{
	return came != 0;
}

void interrupt_end(void)
{
	if (!came)
		return;
	signal(came, SIG_DFL);
	raise(came);
}
