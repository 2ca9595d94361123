/* Between the files of the core: the equations, evaluated for an instance as it stands. */
#ifndef EVALUATE_H
#define EVALUATE_H

#include <float.h>
#include <math.h>

#include "core.h"

static inline int finite_number(double value) { return fabs(value) <= DBL_MAX; }

/* Four sums at a time, none of which has to wait for another. */
static inline int all_finite(const double *value, size_t count) {
    double sum[4] = {0.0};
    size_t i = 0;
    for (; i + 4 <= count; i += 4)
        for (int k = 0; k < 4; k++) sum[k] += value[i + k] * 0.0;
    for (; i < count; i++) sum[0] += value[i] * 0.0;
    return sum[0] + sum[1] + sum[2] + sum[3] == 0.0;
}

/* Name of a state, or of an input that follows its tangent, that is not finite; NULL if none. */
const char *first_lost(const double *x, const double *u);

/* Nothing of the caches holds for other derived constants. */
void forget_caches(Instance *instance);

/* The instance is about to be freed. */
void release_equations(Instance *instance);

/* Compute what is stale, and all that it follows from. */
Status refresh_states(Instance *instance);
Status refresh_outputs(Instance *instance);

/* Time derivatives of the continuous states; fails where one is not finite. */
Status evaluate_derivatives(Instance *instance, double *rate);
Status evaluate_indicators(Instance *instance, double *indicator);
Status evaluate_constants(Instance *instance, double *constant);
/* Let memory and modes follow the states and inputs. */
Status update_memory(Instance *instance);

/* Place of a value reference in a table of the continuous states; -1 if it is not there. */
int continuous_place(const uint32_t *table, uint32_t reference);

#endif
