/* The few types of FMI 3.0 that its functions need, declared here so that the sources stand alone, and
 * what the files of its functions share. */
#ifndef FMI3_H
#define FMI3_H

#include <stdbool.h>

#include "arrays.h"
#include "slave.h"

typedef void *fmi3Instance, *fmi3InstanceEnvironment, *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef double fmi3Float64;
typedef int fmi3Status;
typedef bool fmi3Boolean, fmi3Clock;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef enum {
    fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent
} fmi3DependencyKind;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64 time,
                                               fmi3Boolean set_requested, fmi3Boolean get_allowed,
                                               fmi3Boolean step_finished, fmi3Boolean can_return_early,
                                               fmi3Boolean *return_requested, fmi3Float64 *return_time);

/* What the importer may do at an intermediate update: set inputs before a micro step, or read what
 * has come of it afterwards. */
typedef enum { NO_UPDATE, BEFORE_MICRO_STEP, AFTER_MICRO_STEP } Update;

typedef struct {
    Slave slave;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    fmi3IntermediateUpdateCallback update;
    bool early_return, reads_intermediate;
    Update now;
    double micro; /* length of the micro step under way */
} Fmu;

#define CORE (((Slave *)c)->core)
#define NOW (((Fmu *)c)->now)
#define NEEDS_NO_UPDATE \
    if (NOW != NO_UPDATE) return slave_refuse(c, "this call has to wait for the end of the step: an intermediate update is under way")
#define NEEDS_READABLE \
    if (NOW == BEFORE_MICRO_STEP) return slave_refuse(c, "before a micro step inputs are set, and nothing can be read")

/* The references of a variable's elements: a scalar's own, or those that an array gathers. Event
 * indicators have none. */
size_t elements(const fmi3ValueReference *vr, const uint32_t **element);
/* Whether the variables have as many values as the importer says; scalar: whether each has one. */
Status check_count(Slave *c, const fmi3ValueReference vr[], size_t count, size_t value_count, int *scalar);

#endif
