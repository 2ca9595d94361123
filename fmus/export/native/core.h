/* One instance of a block: its state, and the calls that both FMI versions are thin layers over.
 * The block itself (counts, variables, equations) is in the generated block.h and block.c. */
#ifndef CORE_H
#define CORE_H

#include <stddef.h>
#include <stdint.h>

#include "block.h"
#include "names.h"

/* Value references: 0 is time, then the parameters, inputs, outputs, local variables and constants,
 * each in block order. Local are the derivatives of continuous states that are no outputs, then the
 * memory. */
enum {
    FIRST_PARAMETER = 1,
    FIRST_INPUT = FIRST_PARAMETER + N_PARAMETERS,
    FIRST_OUTPUT = FIRST_INPUT + N_INPUTS,
    FIRST_LOCAL = FIRST_OUTPUT + N_OUTPUTS,
    FIRST_MEMORY = FIRST_LOCAL + N_LOCALS - N_MEMORY,
    FIRST_CONSTANT = FIRST_LOCAL + N_LOCALS,
    N_REFERENCES = FIRST_CONSTANT + N_CONSTANTS
};

/* WHOLE is how FMI 2.0 asks: for an integer or an enumeration. */
typedef enum { REAL, INTEGER, BOOLEAN, ENUMERATION, WHOLE } Kind;

typedef enum { OK = 0, WARNING = 1, ERROR = 3 } Status;

typedef enum { MODEL_EXCHANGE, CO_SIMULATION } Interface;

/* STEPPING is co-simulation's, EVENT_MODE and CONTINUOUS_MODE are model exchange's. */
typedef enum { INSTANTIATED, INITIALIZING, STEPPING, EVENT_MODE, CONTINUOUS_MODE, TERMINATED } Phase;

typedef struct {
    const char *name;
    const char *unit;
    Kind kind;
    int tunable;
    double start, minimum, maximum;
} VariableInfo;

/* Parameters and inputs, by value reference - 1. */
extern const VariableInfo VARIABLE_INFO[];
/* All value references: each its own. */
extern const uint32_t REFERENCE[];
/* Outputs, local variables and constants, by value reference - FIRST_OUTPUT. */
extern const char *const CALCULATED_NAME[];
/* The continuous states come first. */
extern const char *const STATE_NAME[];
extern const double STATE_NOMINAL[];
extern const uint32_t STATE_REFERENCE[], DERIVATIVE_REFERENCE[];

/* All that a rollback restores; a copy of this struct is a saved state. */
typedef struct {
    double time;
    double value[FIRST_LOCAL];
    double given[N_INPUTS + 1]; /* inputs as last set, less the block's own motion since */
    double rate[N_INPUTS + 1];
    double x[N_STATES + 1];
    double mode[N_MODES + 1];
    double d[N_DERIVED + 1];
    Phase phase;
    int derived_stale, states_stale, outputs_stale, slopes_stale;
} State;

typedef void (*Report)(void *environment, Status status, const char *message);

typedef struct {
    State state;
    Interface interface;
    Report report;
    void *environment;
    /* Pages of the table: a cache that follows from the state's derived constants alone. */
    double page[TABLE_SLOTS][TABLE_PAGE_SIZE + 1];
    int64_t page_number[TABLE_SLOTS];
    int page_filled[TABLE_SLOTS];
    /* What steps of that size need, also a cache of the kind; a size below 0 is of none. */
    double transition[N_TRANSITION + 1], transition_size;
    double lookup[TABLE_ROWS * TABLE_STATIONS + 1];
    /* Of the first outputs by all inputs, where these and the states are now. */
    double slope[N_LED * N_INPUTS + 1];
    long long iw[WORK_IW + 1];
    double w[WORK_W + 1];
    void *within; /* what the equations keep besides, if they are those of other FMUs */
} Instance;

Instance *core_create(Interface interface, Report report, void *environment);
void core_free(Instance *instance);
void core_reset(Instance *instance);
Status core_start(Instance *instance, double time);
/* Model exchange goes on in event mode. */
Status core_finish_initialization(Instance *instance);
Status core_terminate(Instance *instance);
Status core_set(Instance *instance, const uint32_t *reference, size_t count, const double *value);
Status core_set_kind(Instance *instance, uint32_t reference, Kind kind, double value);
Status core_set_rates(Instance *instance, const uint32_t *reference, size_t count, const double *rate);
Status core_get(Instance *instance, const uint32_t *reference, size_t count, double *value);
Status core_get_kind(Instance *instance, uint32_t reference, Kind kind, double *value);
Status core_step(Instance *instance, double time, double size);
/* The parts of a step: how many micro steps it takes, and that many at once, or one after the other
 * with inputs for the end of each, which they reach along a line. */
Status core_plan(Instance *instance, double time, double size, long *count);
Status core_advance(Instance *instance, double time, double size, long count);
Status core_set_ahead(Instance *instance, const uint32_t *reference, size_t count, const double *value,
                      double size);
/* unknown: outputs and derivatives; known: inputs and continuous states. */
Status core_directional(Instance *instance, const uint32_t *unknown, size_t unknown_count,
                        const uint32_t *known, size_t known_count, const double *seed,
                        double *sensitivity);
Status core_restore(Instance *instance, const State *state);
/* Whether a state that came as bytes could be one of this block's. */
Status core_check_state(Instance *instance, const State *state);
/* Saved states as an importer holds them: saving makes room at `state` unless it has some. `pack`
 * makes bytes of one, so many as `packed_size` says, and `unpack` refuses those that were damaged. */
Status core_save(Instance *instance, void **state);
Status core_load(Instance *instance, const void *state);
void core_free_state(Instance *instance, void *state);
Status core_packed_size(Instance *instance, const void *state, size_t *size);
Status core_pack(Instance *instance, const void *state, void *bytes);
Status core_unpack(Instance *instance, const void *bytes, size_t size, void **state);

/* Model exchange. `count` must be the number of continuous states, or of event indicators. */
Status core_enter_event_mode(Instance *instance);
Status core_new_discrete_states(Instance *instance);
Status core_enter_continuous_mode(Instance *instance);
Status core_set_time(Instance *instance, double time);
Status core_set_continuous_states(Instance *instance, const double *x, size_t count);
Status core_get_continuous_states(Instance *instance, double *x, size_t count);
Status core_nominals(Instance *instance, double *nominal, size_t count);
Status core_derivatives(Instance *instance, double *rate, size_t count);
Status core_event_indicators(Instance *instance, double *indicator, size_t count);
/* event: whether event mode is to be entered now. */
Status core_completed_step(Instance *instance, int *event);
Status core_fail(Instance *instance, const char *format, ...);

#endif
