/* FMI 3.0's arrays: their value references follow those of the core's scalars, and that of the event
 * indicators comes last. The tables are in the generated arrays.c. */
#ifndef ARRAYS_H
#define ARRAYS_H

#include "core.h"

enum { EVENT_INDICATORS = N_REFERENCES + N_ARRAYS };

typedef struct {
    uint32_t variable, element;
} Dependency;

/* Array n has the scalars ARRAY_ELEMENT[ARRAY_START[n]] up to, not including, that of n + 1. */
extern const uint32_t ARRAY_ELEMENT[], ARRAY_START[];
/* Whether a scalar is an element and no variable of its own, by value reference. */
extern const unsigned char IN_ARRAY[];
/* What a calculated scalar depends on, by value reference - FIRST_OUTPUT, in the same way. */
extern const Dependency DEPENDENCY[];
extern const uint32_t DEPENDENCY_START[];

#endif
