#version 450 core
// Under a budget: the lowest bucket that is still taken. Stages 0 and 2, before enlist.comp, of the rows to assess and
// to refresh: one group adds up rows or rays from the top bucket on; the first bucket that holds any is always taken,
// so every update gets on. Stages 1 and 3: group counts for the rows that were listed.
#define READ_FRAME
#define READ_CHOICES
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint stage;

const uint ASSESS = 0u, ASSESS_GROUPS = 1u, REFRESH = 2u, REFRESH_GROUPS = 3u;

const uint SHARE = GI_BUCKETS / GI_GROUP_SIZE;

shared uint cost_of[GI_GROUP_SIZE];

uint threshold(uint first, uint budget)
{
	uint sum = 0u, lowest = GI_BUCKETS;
	for (uint group = GI_GROUP_SIZE; group-- > 0u;) {
		if (cost_of[group] == 0u)
			continue;
		if (sum + cost_of[group] <= budget) {
			sum += cost_of[group];
			lowest = group * SHARE;
			continue;
		}
		for (uint k = (group + 1u) * SHARE; k-- > group * SHARE;) {
			if (sum > 0u && sum + load_choice(first + k) > budget)
				return k + 1u;
			sum += load_choice(first + k);
		}
		return group * SHARE;
	}
	return lowest;
}

void count_groups()
{
	if (stage == ASSESS_GROUPS) {
		state.counts.assessed_rows = min(state.counts.assessed_rows, frame.budget.z);
		state.assess = folded(spread_groups(state.counts.assessed_rows));
	} else {
		state.chosen = folded(spread_groups(state.refresh.chosen_rows));
		state.pairs = folded(groups_for(state.refresh.chosen_rows * source_count()));
	}
}

void main()
{
	uint local = gl_LocalInvocationID.x, first = stage == ASSESS ? GI_CHOICE_ROWS : 0u;
	bool choose = stage == ASSESS || stage == REFRESH;
	uint sum = 0u;
	for (uint k = 0u; choose && k < SHARE; k++)
		sum += load_choice(first + local * SHARE + k);
	cost_of[local] = sum;
	barrier();
	if (local > 0u)
		return;
	if (stage == ASSESS)
		state.budget.lowest_assessed = max(threshold(first, frame.budget.z), 1u);
	else if (stage == REFRESH)
		state.budget.lowest_chosen = max(threshold(first, uint(min(frame.limit.x, 4e9))), 1u);
	else
		count_groups();
}
