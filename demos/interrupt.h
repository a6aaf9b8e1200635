/* Signals that end the program (SIGINT, SIGTERM, SIGHUP) let it finish the frame and its files first; a second one ends
 * it at once.
 */
#ifndef DEMOS_INTERRUPT_H
#define DEMOS_INTERRUPT_H

#include <stdbool.h>

/* From now on; a signal that is ignored, by nohup, stays so. */
void interrupt_begin(void);

bool interrupt_came(void);

/* Ends the program as the signal would have, if one came. */
void interrupt_end(void);

#endif
