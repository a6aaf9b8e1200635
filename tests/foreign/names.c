/* Functions that a host may well have, with names that the library has inside. */
int bvh_build(void);
int scene_find(void);
int gpu_bind(void);
int rows_update(void);

int bvh_build(void)
{
	return 1;
}

int scene_find(void)
{
	return 2;
}

int gpu_bind(void)
{
	return 3;
}

int rows_update(void)
{
	return 4;
}
