#include "parallel.h"

#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

enum { MOST_THREADS = 64 };

typedef struct loop {
	parallel_fn *work;
	void *user;
	uint32_t count;
	atomic_uint next;
} loop;

static void *run(void *argument)
{
	loop *l = argument;
	for (;;) {
		const uint32_t number = atomic_fetch_add(&l->next, 1);
		if (number >= l->count)
			return NULL;
		l->work(l->user, number);
	}
}

static uint32_t wanted_threads(uint32_t threads)
{
	const long processors = threads ? (long)threads : sysconf(_SC_NPROCESSORS_ONLN);
	return processors < 1 ? 1 : processors > MOST_THREADS ? MOST_THREADS : (uint32_t)processors;
}

void parallel_for(uint32_t threads, uint32_t count, parallel_fn *work, void *user)
{
	loop l = {.work = work, .user = user, .count = count};
	pthread_t others[MOST_THREADS];
	uint32_t started = 0;
	while (started + 1 < wanted_threads(threads) && pthread_create(&others[started], NULL, run, &l) == 0)
		started++;
	run(&l);
	while (started > 0)
		pthread_join(others[--started], NULL);
}
