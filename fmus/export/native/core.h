/* One instance of a block: its state, and the calls that both FMI versions are thin layers over.
 * The block itself (counts, variables, equations) is in the generated block.h and block.c. */
#ifndef CORE_H
#define CORE_H

#include <stddef.h>
#include <stdint.h>

#include "block.h"

/* Value references: 0 is time, then the parameters, inputs and outputs, each in block order. */
enum {
    FIRST_PARAMETER = 1,
    FIRST_INPUT = FIRST_PARAMETER + N_PARAMETERS,
    FIRST_OUTPUT = FIRST_INPUT + N_INPUTS,
    N_VALUES = FIRST_OUTPUT + N_OUTPUTS
};

typedef enum { REAL, INTEGER, BOOLEAN, ENUMERATION } Kind;

typedef enum { OK = 0, WARNING = 1, ERROR = 3 } Status;

typedef enum { INSTANTIATED, INITIALIZING, RUNNING, TERMINATED } Phase;

typedef struct {
    const char *name;
    const char *unit;
    Kind kind;
    int tunable;
    double start, minimum, maximum;
} VariableInfo;

/* Parameters and inputs, by value reference - 1. */
extern const VariableInfo VARIABLE_INFO[];
extern const char *const OUTPUT_NAME[];
extern const char *const STATE_NAME[];

/* All that a rollback restores; a copy of this struct is a saved state. */
typedef struct {
    double time;
    double value[N_VALUES];
    double rate[N_INPUTS + 1];
    double x[N_STATES + 1];
    double d[N_DERIVED + 1];
    Phase phase;
    int derived_stale, states_stale, outputs_stale;
} State;

typedef void (*Report)(void *environment, Status status, const char *message);

typedef struct {
    State state;
    Report report;
    void *environment;
    /* Pages of the table: a cache that follows from the state's derived constants alone. */
    double page[TABLE_SLOTS][TABLE_PAGE_SIZE + 1];
    int64_t page_number[TABLE_SLOTS];
    int page_filled[TABLE_SLOTS];
    double lookup[TABLE_ROWS * TABLE_STATIONS + 1];
    const double *arg[WORK_ARG + 1];
    double *res[WORK_RES + 1];
    long long iw[WORK_IW + 1];
    double w[WORK_W + 1];
} Instance;

Instance *core_create(Report report, void *environment);
void core_free(Instance *instance);
void core_reset(Instance *instance);
Status core_start(Instance *instance, double time);
Status core_finish_initialization(Instance *instance);
Status core_set(Instance *instance, const uint32_t *reference, size_t count, const double *value);
Status core_set_kind(Instance *instance, uint32_t reference, Kind kind, double value);
Status core_set_rate(Instance *instance, uint32_t reference, double rate);
Status core_get(Instance *instance, const uint32_t *reference, size_t count, double *value);
Status core_get_kind(Instance *instance, uint32_t reference, Kind kind, double *value);
Status core_step(Instance *instance, double time, double size);
Status core_directional(Instance *instance, const uint32_t *unknown, size_t unknown_count,
                        const uint32_t *known, size_t known_count, const double *seed,
                        double *sensitivity);
void core_restore(Instance *instance, const State *state);
Status core_fail(Instance *instance, const char *format, ...);

#endif
