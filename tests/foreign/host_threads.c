/* Two contexts on two threads, each with an OpenGL context and OpenGL functions of its own. Both update at the same
 * time, again and again, and get the bits that one alone gets; neither calls the other's functions. */
#include "headless.h"
#include "room.h"

#include <pthread.h>

enum { ROUNDS = 8 };

typedef void dispatch_function(unsigned x, unsigned y, unsigned z);

/* What the library's dispatches of each thread go through. */
static dispatch_function *driver_dispatch;
static pthread_t thread_of[2];
static unsigned calls[2], strangers;

static void dispatch(int k, unsigned x, unsigned y, unsigned z)
{
	calls[k]++;
	if (!pthread_equal(pthread_self(), thread_of[k]))
		__atomic_fetch_add(&strangers, 1, __ATOMIC_RELAXED);
	driver_dispatch(x, y, z);
}

static void dispatch_0(unsigned x, unsigned y, unsigned z)
{
	dispatch(0, x, y, z);
}

static void dispatch_1(unsigned x, unsigned y, unsigned z)
{
	dispatch(1, x, y, z);
}

static gi_proc find_gl(const char *name, void *user)
{
	static dispatch_function *const own[2] = {dispatch_0, dispatch_1};
	return strcmp(name, "glDispatchCompute") == 0 ? (gi_proc)own[*(const int *)user] : (gi_proc)headless_find(name);
}

typedef struct job {
	EGLDisplay display;
	int number;
	bool failed;
	gi_leaf leaves[ROOM_LEAVES];
} job;

static bool update_again(gi_context *gi, gi_leaf leaves[ROOM_LEAVES])
{
	uint32_t count;
	bool good = true;
	for (int k = 0; good && k < ROUNDS; k++) {
		gi_invalidate(gi);
		gi_reset_radiosity(gi);
		good = !gi_update(gi, NULL) && !gi_read_leaves(gi, leaves, ROOM_LEAVES, &count);
	}
	room_forget_context(leaves);
	return good;
}

static void *work(void *data)
{
	job *j = data;
	thread_of[j->number] = pthread_self();
	const EGLContext context = headless_open(j->display);
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = find_gl;
	def.get_proc_user = &j->number;
	gi_context *gi = NULL;
	j->failed = gi_context_create(&def, &gi) || room_light(gi, j->leaves) || !update_again(gi, j->leaves);
	gi_context_destroy(gi);
	eglMakeCurrent(j->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	eglDestroyContext(j->display, context);
	return NULL;
}

int main(void)
{
	static job alone, both[2];
	pthread_t threads[2];
	alone.display = both[0].display = both[1].display = headless_display();
	both[1].number = 1;
	driver_dispatch = (dispatch_function *)headless_find("glDispatchCompute");
	work(&alone);
	for (int k = 0; k < 2; k++)
		if (pthread_create(&threads[k], NULL, work, &both[k]))
			return 1;
	for (int k = 0; k < 2; k++)
		pthread_join(threads[k], NULL);
	if (alone.failed || both[0].failed || both[1].failed)
		return 1;
	printf("dispatches: %u and %u, %u of them of another thread\n", calls[0], calls[1], strangers);
	for (int k = 0; k < 2; k++)
		if (memcmp(both[k].leaves, alone.leaves, sizeof alone.leaves)) {
			printf("thread %d has other light than one alone\n", k);
			return 1;
		}
	/* The first thread's are those of two runs. */
	return strangers || calls[0] != 2 * calls[1] || !room_is_lit("two threads", alone.leaves);
}
