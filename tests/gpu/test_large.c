/* Rows of more than the 128 MiB that llvmpipe promises a storage block: 8 million entries of 16 bytes. They are a
 * rebuild's, to the bit, and sum to at most 1 wherever they lie in the pool. */
#include "scenes/cornell.h"
#include "snapshot.h"

#include <stdio.h>

static const uint64_t BLOCK_ENTRIES = (128u << 20) / 16;

static void beyond_a_block(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	def.row_tolerance = 4e-4f;
	def.emitter_refinement = 1;
	def.near_samples = 1;
	gi_context *gi = harness_context(&def);
	const cornell_def box = cornell_def_default();
	cornell c;
	assert_gi(cornell_create(gi, &box, &c));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_gi(gi_set_pose(gi, c.balls[0], (gi_pose){.position = {-1.5f, .6f, -1.5f}, .rotation = {0, 0, 0, 1}}));
	const gi_report moved = harness_update(gi);
	printf("  %.1f million entries, %.1f million links\n", 1e-6 * (double)moved.entries,
	       1e-6 * (double)moved.links);
	assert_true(moved.entries > BLOCK_ENTRIES);
	snapshot updated = snapshot_take(gi);
	for (uint32_t k = 0; k < updated.leaf_count; k++)
		assert_true(updated.leaves[k].row_sum >= 0 && updated.leaves[k].row_sum <= 1);
	gi_invalidate(gi);
	harness_update(gi);
	snapshot rebuilt = snapshot_take(gi);
	snapshot_expect_same_rows(&updated, &rebuilt, "beyond a block");
	snapshot_free(&updated);
	snapshot_free(&rebuilt);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(beyond_a_block)};
	return cmocka_run_group_tests_name("large", tests, harness_open, harness_close);
}
