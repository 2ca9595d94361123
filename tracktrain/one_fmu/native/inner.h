/* An FMU that is compiled into this one: FMI 2.0's functions of it, which have a prefix of its own. */
#ifndef INNER_H
#define INNER_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} Callbacks;

typedef void (*Function)(void);

typedef struct {
    const char *guid;
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
    void (*free)(void *);
    int (*setup)(void *, int, double, double, int, double);
    int (*enter)(void *);
    int (*leave)(void *);
    int (*terminate)(void *);
    int (*reset)(void *);
    int (*set_real)(void *, const uint32_t *, size_t, const double *);
    int (*set_integer)(void *, const uint32_t *, size_t, const int *);
    int (*set_boolean)(void *, const uint32_t *, size_t, const int *);
    int (*get_state)(void *, void **);
    int (*set_state)(void *, void *);
    int (*free_state)(void *, void **);
    int (*packed_size)(void *, void *, size_t *);
    int (*pack)(void *, void *, char *, size_t);
    int (*unpack)(void *, const char *, size_t, void **);
    Function call[7]; /* those that a macro step calls, in the order of CALL_NAME */
} Fmu2;

#define DECLARE_FMU(p)                                                                                    \
    void *p##fmi2Instantiate(const char *, int, const char *, const char *, const Callbacks *, int, int); \
    void p##fmi2FreeInstance(void *);                                                                     \
    int p##fmi2SetupExperiment(void *, int, double, double, int, double);                                 \
    int p##fmi2EnterInitializationMode(void *);                                                           \
    int p##fmi2ExitInitializationMode(void *);                                                            \
    int p##fmi2Terminate(void *);                                                                         \
    int p##fmi2Reset(void *);                                                                             \
    int p##fmi2SetReal(void *, const uint32_t *, size_t, const double *);                                 \
    int p##fmi2SetInteger(void *, const uint32_t *, size_t, const int *);                                 \
    int p##fmi2SetBoolean(void *, const uint32_t *, size_t, const int *);                                 \
    int p##fmi2GetFMUstate(void *, void **);                                                              \
    int p##fmi2SetFMUstate(void *, void *);                                                               \
    int p##fmi2FreeFMUstate(void *, void **);                                                             \
    int p##fmi2SerializedFMUstateSize(void *, void *, size_t *);                                          \
    int p##fmi2SerializeFMUstate(void *, void *, char *, size_t);                                         \
    int p##fmi2DeSerializeFMUstate(void *, const char *, size_t, void **);                                \
    int p##fmi2GetReal(void *, const uint32_t *, size_t, double *);                                       \
    int p##fmi2DoStep(void *, double, double, int);                                                       \
    int p##fmi2SetRealInputDerivatives(void *, const uint32_t *, size_t, const int *, const double *);    \
    int p##fmi2GetDirectionalDerivative(void *, const uint32_t *, size_t, const uint32_t *, size_t,       \
                                        const double *, double *);

#define FMU(p, guid)                                                                                     \
    {                                                                                                    \
        guid, p##fmi2Instantiate, p##fmi2FreeInstance, p##fmi2SetupExperiment,                           \
            p##fmi2EnterInitializationMode, p##fmi2ExitInitializationMode, p##fmi2Terminate,             \
            p##fmi2Reset, p##fmi2SetReal, p##fmi2SetInteger, p##fmi2SetBoolean, p##fmi2GetFMUstate,      \
            p##fmi2SetFMUstate, p##fmi2FreeFMUstate, p##fmi2SerializedFMUstateSize,                      \
            p##fmi2SerializeFMUstate, p##fmi2DeSerializeFMUstate, {                                      \
            (Function)p##fmi2SetReal, (Function)p##fmi2GetReal, (Function)p##fmi2DoStep,                 \
                (Function)p##fmi2SetRealInputDerivatives, (Function)p##fmi2GetDirectionalDerivative,     \
                (Function)p##fmi2GetFMUstate, (Function)p##fmi2SetFMUstate                               \
        }                                                                                                \
    }

#endif
