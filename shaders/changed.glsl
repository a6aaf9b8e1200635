// What changed since a row was refreshed, by the numbers of the updates (rows[leaf].z and gi_object_data.changed).

bool moved_since(uint object, uint update)
{
	return object_changed(object).x > update;
}

// Does the cut of `source` in a row of object `mine` have to be done again?
bool pair_is_dirty(uint mine, uint source, uint update)
{
	uvec4 changed = object_changed(source);
	bool apart = mine != source, moved = apart && (moved_since(mine, update) || changed.x > update);
	return changed.y > update || moved || (!apart && changed.z > update);
}

// Of the static ones a row keeps what it has of nodes that are what they were.
bool pair_keeps_nodes(uint mine, uint source, uint update)
{
	return source == frame.swept.w && !moved_since(mine, update);
}
