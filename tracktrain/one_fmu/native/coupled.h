/* What the instance of a coupled system keeps: the FMUs within, and the master's tables. */
#ifndef COUPLED_H
#define COUPLED_H

#include "evaluate.h"
#include "inner.h"
#include "layout.h"

/* Where a run is: the row of the record that it has reached, and the time grid of the rows. */
typedef struct {
    int64_t row, first;
    double origin, step;
    int stepping, broken;
} Course;

typedef struct {
    Instance *owner;
    Callbacks callbacks;
    void *component[N_WITHIN];
    Course course;
    double given[N_PARAMETERS + 1];                         /* parameters as the FMUs have them */
    double begin, from[N_INPUTS + 1], outside[N_INPUTS + 1]; /* inputs as a step goes along */
    uint64_t image[IMAGE_WORDS];
} Coupled;

/* Brings the FMUs to the mode that the instance is in; makes them where there are none. */
Status bring_along(Instance *instance);

extern const Fmu2 FMU_WITHIN[];
extern const unsigned char FMU_OF[];
/* Of a parameter, by value reference - 1: the instance, and its own value reference. */
typedef struct {
    uint16_t instance;
    uint32_t reference;
} Own;
extern const Own PARAMETER_OF[];

static inline const Fmu2 *fmu_of(int number) { return FMU_WITHIN + FMU_OF[number]; }

#endif
