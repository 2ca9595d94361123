/* FMI 3.0, co-simulation and model exchange: instances, values and saved states over the core. */
#include "evaluate.h"
#include "fmi3.h"

#include <stdlib.h>

static void report(void *environment, Status status, const char *message) {
    Fmu *fmu = environment;
    if (fmu->log)
        fmu->log(fmu->environment, status, status == ERROR ? "logStatusError" : "logStatusWarning", message);
}

EXPORT(const char *, fmi3GetVersion)(void) { return "3.0"; }

EXPORT(fmi3Status, fmi3SetDebugLogging)(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String category[]) {
    (void)on, (void)count, (void)category; /* errors are always told, and there is nothing else */
    return c ? OK : ERROR;
}

static Fmu *instantiate(Interface interface, fmi3String name, fmi3String token,
                        fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, const char *problem) {
    Fmu *fmu = calloc(1, sizeof *fmu);
    if (!fmu) return NULL;
    fmu->environment = environment;
    fmu->log = log;
    problem = slave_create(&fmu->slave, interface, name, token, report, fmu, problem);
    if (!problem) return fmu;
    report(fmu, ERROR, problem);
    slave_clear(&fmu->slave);
    free(fmu);
    return NULL;
}

EXPORT(fmi3Instance, fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                   fmi3Boolean visible, fmi3Boolean logging,
                                                   fmi3InstanceEnvironment environment,
                                                   fmi3LogMessageCallback log) {
    (void)resources, (void)visible, (void)logging;
    return instantiate(MODEL_EXCHANGE, name, token, environment, log, NULL);
}

EXPORT(fmi3Instance, fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                                  fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                                                  fmi3Boolean early_return, const fmi3ValueReference required[],
                                                  size_t required_count, fmi3InstanceEnvironment environment,
                                                  fmi3LogMessageCallback log,
                                                  fmi3IntermediateUpdateCallback update) {
    (void)resources, (void)visible, (void)logging;
    Fmu *fmu = instantiate(CO_SIMULATION, name, token, environment, log,
                           event_mode ? "this FMU has no event mode in co-simulation" : NULL);
    if (!fmu) return NULL;
    fmu->update = update;
    fmu->early_return = early_return;
    for (size_t i = 0; required && i < required_count; i++)
        fmu->reads_intermediate |= required[i] - FIRST_INPUT >= N_INPUTS;
    return fmu;
}

EXPORT(fmi3Instance, fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                                        fmi3Boolean visible, fmi3Boolean logging,
                                                        fmi3InstanceEnvironment environment,
                                                        fmi3LogMessageCallback log, void (*clock)(void *),
                                                        void (*lock)(void), void (*unlock)(void)) {
    (void)resources, (void)visible, (void)logging, (void)clock, (void)lock, (void)unlock;
    return instantiate(CO_SIMULATION, name, token, environment, log,
                       "this FMU offers co-simulation and model exchange, no scheduled execution");
}

EXPORT(void, fmi3FreeInstance)(fmi3Instance c) {
    if (!c || NOW != NO_UPDATE) return;
    slave_clear(c);
    free(c);
}

EXPORT(fmi3Status, fmi3EnterInitializationMode)(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                                fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop) {
    (void)tolerance_defined, (void)tolerance;
    NEEDS_INSTANCE;
    if (slave_experiment(c, start, stop_defined, stop) != OK) return ERROR;
    return slave_enter_initialization(c);
}

EXPORT(fmi3Status, fmi3ExitInitializationMode)(fmi3Instance c) {
    NEEDS_INSTANCE;
    return slave_exit_initialization(c);
}

EXPORT(fmi3Status, fmi3Terminate)(fmi3Instance c) {
    NEEDS_INSTANCE;
    NEEDS_NO_UPDATE;
    return core_terminate(CORE);
}

EXPORT(fmi3Status, fmi3Reset)(fmi3Instance c) {
    NEEDS_INSTANCE;
    NEEDS_NO_UPDATE;
    return slave_reset(c);
}

static int is_array(fmi3ValueReference vr) {
    return vr >= N_REFERENCES && vr < N_REFERENCES + N_ARRAYS + (N_INDICATORS > 0);
}

size_t elements(const fmi3ValueReference *vr, const uint32_t **element) {
    *element = is_array(*vr) ? NULL : vr;
    if (!is_array(*vr)) return 1;
    if (*vr == EVENT_INDICATORS) return N_INDICATORS;
    const uint32_t *first = ARRAY_START + (*vr - N_REFERENCES);
    *element = ARRAY_ELEMENT + first[0];
    return first[1] - first[0];
}

Status check_count(Slave *c, const fmi3ValueReference vr[], size_t count, size_t value_count, int *scalar) {
    const uint32_t *element;
    size_t total = 0;
    *scalar = 1;
    for (size_t i = 0; i < count; i++) {
        int array = is_array(vr[i]);
        if (vr[i] < N_REFERENCES && IN_ARRAY[vr[i]])
            return core_fail(c->core, "value reference %u is no variable: it is an element of one", (unsigned)vr[i]);
        total += array ? elements(vr + i, &element) : 1;
        if (array) *scalar = 0;
    }
    if (total == value_count) return OK;
    return core_fail(c->core, "the %u variables have %u values in all, and the call brings %u", (unsigned)count,
                     (unsigned)total, (unsigned)value_count);
}

EXPORT(fmi3Status, fmi3GetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3Float64 value[],
                                   size_t value_count) {
    int scalar;
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, vr, value);
    NEEDS_READABLE;
    if (check_count(c, vr, count, value_count, &scalar) != OK) return ERROR;
    if (scalar) return core_get(CORE, vr, count, value);
    for (size_t i = 0; i < count; i++) {
        const uint32_t *element;
        size_t size = elements(vr + i, &element);
        Status status = element ? core_get(CORE, element, size, value) : evaluate_indicators(CORE, value);
        if (status != OK) return status;
        value += size;
    }
    return OK;
}

EXPORT(fmi3Status, fmi3SetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                   const fmi3Float64 value[], size_t value_count) {
    int scalar;
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, vr, value);
    NEEDS_SETTABLE;
    if (NOW == AFTER_MICRO_STEP) return slave_refuse(c, "inputs are set before a micro step, and this one is finished");
    if (check_count(c, vr, count, value_count, &scalar) != OK) return ERROR;
    if (NOW != NO_UPDATE)
        return scalar ? core_set_ahead(CORE, vr, count, value, ((Fmu *)c)->micro)
                      : slave_refuse(c, "within a step inputs are set, and no array is an input");
    if (scalar) return core_set(CORE, vr, count, value);
    for (size_t i = 0; i < count; i++) {
        const uint32_t *element;
        size_t size = elements(vr + i, &element);
        if (!element) return slave_refuse(c, "event indicators are calculated and cannot be set");
        if (core_set(CORE, element, size, value) != OK) return ERROR;
        value += size;
    }
    return OK;
}

#define WHOLE_NUMBERS(name, type, kind)                                                                      \
    EXPORT(fmi3Status, fmi3Get##name)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, type value[], \
                                      size_t value_count) {                                                  \
        int scalar;                                                                                          \
        NEEDS_INSTANCE;                                                                                      \
        NEEDS_LISTS(count, vr, value);                                                                       \
        if (check_count(c, vr, count, value_count, &scalar) != OK) return ERROR;                             \
        for (size_t i = 0; i < count; i++) {                                                                 \
            double number;                                                                                   \
            if (core_get_kind(CORE, vr[i], kind, &number) != OK) return ERROR;                               \
            value[i] = (type)number;                                                                         \
        }                                                                                                    \
        return OK;                                                                                           \
    }                                                                                                        \
    EXPORT(fmi3Status, fmi3Set##name)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,           \
                                      const type value[], size_t value_count) {                              \
        int scalar;                                                                                          \
        NEEDS_INSTANCE;                                                                                      \
        NEEDS_LISTS(count, vr, value);                                                                       \
        NEEDS_SETTABLE;                                                                                      \
        NEEDS_NO_UPDATE;                                                                                     \
        if (check_count(c, vr, count, value_count, &scalar) != OK) return ERROR;                             \
        for (size_t i = 0; i < count; i++)                                                                   \
            if (core_set_kind(CORE, vr[i], kind, (double)value[i]) != OK) return ERROR;                      \
        return OK;                                                                                           \
    }
WHOLE_NUMBERS(Int32, int32_t, INTEGER)
WHOLE_NUMBERS(Int64, int64_t, ENUMERATION)
WHOLE_NUMBERS(Boolean, fmi3Boolean, BOOLEAN)

EXPORT(fmi3Status, fmi3GetFMUState)(fmi3Instance c, fmi3FMUState *state) {
    NEEDS_INSTANCE;
    NEEDS_NO_UPDATE;
    return slave_save(c, state);
}

EXPORT(fmi3Status, fmi3SetFMUState)(fmi3Instance c, fmi3FMUState state) {
    NEEDS_INSTANCE;
    NEEDS_NO_UPDATE;
    return slave_restore(c, state);
}

EXPORT(fmi3Status, fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *state) {
    NEEDS_INSTANCE;
    return slave_free_state(c, state);
}

EXPORT(fmi3Status, fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size) {
    NEEDS_INSTANCE;
    return slave_serialized_size(c, state, size);
}

EXPORT(fmi3Status, fmi3SerializeFMUState)(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    NEEDS_INSTANCE;
    return slave_serialize(c, state, bytes, size);
}

EXPORT(fmi3Status, fmi3DeserializeFMUState)(fmi3Instance c, const fmi3Byte bytes[], size_t size,
                                            fmi3FMUState *state) {
    NEEDS_INSTANCE;
    return slave_deserialize(c, bytes, size, state);
}
