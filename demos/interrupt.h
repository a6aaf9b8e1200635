/* Signals that end the program (SIGINT, SIGTERM, SIGHUP) let it finish the frame and its files first. What takes longer
 * than a second is cut off: light of a large scene's first frame may take minutes, and what the driver computes cannot
 * be taken back. A second signal cuts off at once. Either way no file is left half written.
 */
#ifndef DEMOS_INTERRUPT_H
#define DEMOS_INTERRUPT_H

#include <stdbool.h>

/* From now on; a signal that is ignored, by nohup, stays so. */
void interrupt_begin(const char *program);

/* True ends the second's grace: the program is about to end by itself. */
bool interrupt_came(void);

/* Ends the program as the signal would have, if one came. */
void interrupt_end(void);

#endif
