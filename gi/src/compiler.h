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

#endif
