#include "slave.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "identity.h"

static void forget_experiment(Slave *slave) {
    slave->start = 0.0;
    slave->stop = DBL_MAX;
}

const char *slave_create(Slave *slave, Interface interface, const char *name, const char *token,
                         Report report, void *environment, const char *problem) {
    slave->name = malloc(name ? strlen(name) + 1 : 1);
    if (!slave->name) return "not enough memory";
    strcpy(slave->name, name ? name : "");
    if (problem) return problem;
    if (!*slave->name) return "an instance needs a name";
    if (!token || strcmp(token, GUID) != 0)
        return "the GUID differs from the model description's: binary and description do not belong together";
    if (interface == MODEL_EXCHANGE && !HAS_EXCHANGE) return "this FMU is for co-simulation alone";
    slave->core = core_create(interface, report, environment);
    if (!slave->core) return "not enough memory";
    forget_experiment(slave);
    return NULL;
}

void slave_clear(Slave *slave) {
    core_free(slave->core);
    free(slave->name);
}

Status slave_refuse(Slave *slave, const char *what) {
    return slave ? core_fail(slave->core, "%s", what) : ERROR;
}

Status slave_experiment(Slave *slave, double start, int stop_defined, double stop) {
    if (slave->core->state.phase != INSTANTIATED)
        return slave_refuse(slave, "the experiment is set up before initialization");
    if (stop_defined && !(stop >= start)) return slave_refuse(slave, "the stop time lies before the start time");
    slave->start = start;
    slave->stop = stop_defined ? stop : DBL_MAX;
    return OK;
}

Status slave_enter_initialization(Slave *slave) {
    if (slave->core->state.phase != INSTANTIATED)
        return slave_refuse(slave, "initialization is entered once, after instantiation or a reset");
    return core_start(slave->core, slave->start);
}

Status slave_exit_initialization(Slave *slave) {
    if (slave->core->state.phase != INITIALIZING)
        return slave_refuse(slave, "initialization is left after it was entered, and once");
    return core_finish_initialization(slave->core);
}

Status slave_reset(Slave *slave) {
    core_reset(slave->core);
    forget_experiment(slave);
    return OK;
}

Status slave_save(Slave *slave, void **state) {
    if (!state) return slave_refuse(slave, "a place for the state is needed");
    return core_save(slave->core, state);
}

Status slave_restore(Slave *slave, const void *state) {
    if (!state) return slave_refuse(slave, "a saved state is needed");
    return core_load(slave->core, state);
}

Status slave_free_state(Slave *slave, void **state) {
    if (state && *state) {
        core_free_state(slave->core, *state);
        *state = NULL;
    }
    return OK;
}

/* Serialized: the GUID, by which another build's bytes are refused, a checksum, the state's bytes. */
enum { CHECKSUM = sizeof GUID, BODY = CHECKSUM + sizeof(uint64_t) };

/* FNV-1a, 64 bits: http://www.isthe.com/chongo/tech/comp/fnv */
static uint64_t checksum(const unsigned char *byte, size_t size) {
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < size; i++) sum = (sum ^ byte[i]) * UINT64_C(0x100000001b3);
    return sum;
}

Status slave_serialized_size(Slave *slave, const void *state, size_t *size) {
    if (!state || !size) return slave_refuse(slave, "a saved state and a place for its size are needed");
    if (core_packed_size(slave->core, state, size) != OK) return ERROR;
    *size += BODY;
    return OK;
}

Status slave_serialize(Slave *slave, const void *state, void *bytes, size_t size) {
    size_t body;
    if (!state || !bytes || core_packed_size(slave->core, state, &body) != OK || size < BODY + body)
        return slave_refuse(slave, "too few bytes to serialize the state into");
    memcpy(bytes, GUID, sizeof GUID);
    if (core_pack(slave->core, state, (char *)bytes + BODY) != OK) return ERROR;
    uint64_t sum = checksum((unsigned char *)bytes + BODY, body);
    memcpy((char *)bytes + CHECKSUM, &sum, sizeof sum);
    return OK;
}

Status slave_deserialize(Slave *slave, const void *bytes, size_t size, void **state) {
    uint64_t sum;
    if (!bytes || !state || size < BODY || memcmp(bytes, GUID, sizeof GUID) != 0)
        return slave_refuse(slave, "these bytes are no state of this FMU, or of another build of it");
    memcpy(&sum, (const char *)bytes + CHECKSUM, sizeof sum);
    if (sum != checksum((const unsigned char *)bytes + BODY, size - BODY))
        return slave_refuse(slave, "these bytes are a damaged state: the checksum does not fit");
    return core_unpack(slave->core, (const char *)bytes + BODY, size - BODY, state);
}
