/* Time that only goes forward: what C17's own clocks do not promise. */
#ifndef GI_CLOCK_H
#define GI_CLOCK_H

/* Milliseconds since some moment before the program began. */
double gi_clock_ms(void);

#endif
