/* The few types of FMI 2.0 that its functions need, declared here so that the sources stand alone. */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef void *fmi2Component;
typedef void *fmi2FMUstate;
typedef uint32_t fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean, fmi2Status, fmi2Type, fmi2StatusKind;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef struct {
    void (*logger)(void *, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(void *, fmi2Status);
    void *componentEnvironment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged,
        valuesOfContinuousStatesChanged, nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

enum { FMI2_OK, FMI2_WARNING, FMI2_DISCARD, FMI2_ERROR, FMI2_FATAL, FMI2_PENDING };
enum { FMI2_LAST_SUCCESSFUL_TIME = 2, FMI2_TERMINATED = 3 };

/* Logs a message. A logger formats what it is given as printf does, but importers that cannot show it
 * as it is: so the message itself is the format, its % doubled, and has no arguments. */
static inline void fmi2_log(const fmi2CallbackFunctions *callbacks, fmi2String name, fmi2Status status,
                            fmi2String category, const char *message) {
    char *format = malloc(2 * strlen(message) + 1), *end = format;
    if (!format) return;
    for (; *message; *end++ = *message++)
        if (*message == '%') *end++ = '%';
    *end = '\0';
    callbacks->logger(callbacks->componentEnvironment, name, status, category, format);
    free(format);
}

#endif
