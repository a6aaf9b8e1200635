/* Everything a context computed, read back and sorted: what tests compare.
 *
 * Reading fails the test on error. Sorted by (leaf, node), which is unique: a row holds a node once.
 */
#ifndef TESTS_SNAPSHOT_H
#define TESTS_SNAPSHOT_H

#include "harness.h"

typedef struct snapshot {
	gi_leaf *leaves;
	gi_entry *entries;
	gi_link *links;
	uint32_t leaf_count;
	uint64_t entry_count, link_count;
} snapshot;

snapshot snapshot_take(gi_context *gi);
void snapshot_free(snapshot *s);

/* Fails, saying where, unless all entries, links and row sums are the same bytes. */
void snapshot_expect_same_rows(const snapshot *a, const snapshot *b, const char *when);

/* The same of the rows as they are and of those that are built anew, which then are those of gi. */
void snapshot_expect_rebuilt_rows(gi_context *gi, const char *when);

/* Largest |B_a - B_b| over leaves and channels, and largest B of a. */
double snapshot_distance(const snapshot *a, const snapshot *b);
double snapshot_largest(const snapshot *s);

/* Area-weighted RMS of H against path tracing of the context that it was taken of, relative to the RMS of H and free
 * of the paths' noise. */
double snapshot_light_error(gi_context *gi, const snapshot *s, uint32_t paths);

/* FNV-1a over entries and links, and over the bits of B. */
uint64_t snapshot_hash_rows(const snapshot *s);
uint64_t snapshot_hash_radiosity(const snapshot *s);

#endif
