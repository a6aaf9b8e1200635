/* What compilers have under different names. */
#ifndef GI_COMPILER_H
#define GI_COMPILER_H

/* Arguments from number `first` on are those of the printf format that is number `text`; both from 1. */
#if defined(__GNUC__)
#define GI_FORMAT(text, first) __attribute__((format(printf, text, first)))
#else
#define GI_FORMAT(text, first)
#endif

#if defined(_MSC_VER)
#define GI_THREAD_LOCAL __declspec(thread)
#else
#define GI_THREAD_LOCAL _Thread_local
#endif

/* Adds one to a static uint32_t, which threads share, and is what it is then. */
#if defined(_MSC_VER)
#include <intrin.h>
#define GI_COUNT_UP(counter) ((uint32_t)_InterlockedIncrement((volatile long *)(counter)))
#else
#define GI_COUNT_UP(counter) __atomic_add_fetch(counter, 1u, __ATOMIC_RELAXED)
#endif

#endif
