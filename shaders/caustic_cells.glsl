// How dense photons lie where one arrived: a grid in the world of eight levels, whose cells are hashed.

uint cell_of(vec3 p, uint pair, uint level, float finest)
{
	ivec3 cell = ivec3(floor(p / (finest * float(1u << level))));
	uint x =
	    uint(cell.x) * 0x9E3779B9u ^ uint(cell.y) * 0x85EBCA6Bu ^ uint(cell.z) * 0xC2B2AE35u ^ pair * 0x27D4EB2Fu;
	x = (x ^ (x >> 15u)) * 0x2C1B3C6Du;
	x = (x ^ (x >> 12u)) * 0x297A2D39u;
	return level * GI_CAUSTIC_CELLS + ((x ^ (x >> 15u)) & (GI_CAUSTIC_CELLS - 1u));
}

// Of the finest level's cells, as a share of the smooth object's radius.
const float FINEST = 1.0 / 64.0;
