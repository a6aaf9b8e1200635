#ifndef DEMOS_WALL_CLOCK_H
#define DEMOS_WALL_CLOCK_H

/* Milliseconds of a clock that only goes forward. */
double wall_clock_ms(void);

#endif
