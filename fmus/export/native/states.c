/* Saved states of a block: copies of the struct `State`. */
#include <stdlib.h>
#include <string.h>

#include "core.h"

static Status make_room(Instance *instance, void **state) {
    if (!*state) *state = malloc(sizeof(State));
    return *state ? OK : core_fail(instance, "not enough memory for a state");
}

Status core_save(Instance *instance, void **state) {
    if (make_room(instance, state) != OK) return ERROR;
    memcpy(*state, &instance->state, sizeof(State));
    return OK;
}

Status core_load(Instance *instance, const void *state) { return core_restore(instance, state); }

void core_free_state(Instance *instance, void *state) {
    (void)instance;
    free(state);
}

Status core_packed_size(Instance *instance, const void *state, size_t *size) {
    (void)instance, (void)state;
    *size = sizeof(State);
    return OK;
}

Status core_pack(Instance *instance, const void *state, void *bytes) {
    (void)instance;
    memcpy(bytes, state, sizeof(State));
    return OK;
}

Status core_unpack(Instance *instance, const void *bytes, size_t size, void **state) {
    State given;
    if (size != sizeof given) return core_fail(instance, "these bytes are no state of this FMU");
    memcpy(&given, bytes, sizeof given);
    if (core_check_state(instance, &given) != OK || make_room(instance, state) != OK) return ERROR;
    given.derived_stale = 1; /* what follows from the rest is computed, not believed */
    if (given.phase <= INITIALIZING) given.states_stale = 1;
    memcpy(*state, &given, sizeof given);
    return OK;
}
