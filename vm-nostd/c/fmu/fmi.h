/* What FMI 2.0 and 3.0 have alike. Before it is included, FMI(name) is a name of the version, HANDLE an instance and BYTE
   a byte; Unit has a `state`, failed() tells the host's log, and take() and give() allocate. */

/* Does something with an instance; an error is told to the host's log. */
#define DO(call)                                                                                                       \
    char message[MESSAGE];                                                                                             \
    Unit *const unit = c;                                                                                              \
    if (!unit) return FMI(Error);                                                                                      \
    return (call) ? failed(unit, message) : FMI(OK)

/* The same that a function of no use to this unit says. */
static FMI(Status) none(HANDLE c, size_t n, const char *what) {
    if (!c) return FMI(Error);
    return n ? failed(c, what) : FMI(OK);
}

FMI(Status) FMI(ExitInitializationMode)(HANDLE c) { DO(unit_initialize(&unit->state, message)); }

FMI(Status) FMI(Terminate)(HANDLE c) { DO(unit_terminate(&unit->state, message)); }

static int reset(Unit *unit, char *message) {
    message[0] = 0;
    unit->state = unit_start();
    return 0;
}
FMI(Status) FMI(Reset)(HANDLE c) { DO(reset(unit, message)); }

/* A pointer that is to be a state. */
static int missing(const void *state, const char *what, char *message) {
    if (state && memcmp(state, "VM_FMU_2", 8) == 0) return 0;
    snprintf(message, MESSAGE, "%s", what);
    return 1;
}

static int keep(Unit *unit, const State *state, void **place, char *message) {
    if (place && !*place) *place = take(unit, sizeof *state);
    if (!place || !*place) {
        snprintf(message, MESSAGE, "no memory for a state");
        return 1;
    }
    *(State *)*place = *state;
    return 0;
}

static int restore(Unit *unit, const State *state, char *message) {
    if (missing(state, "no state of this unit", message)) return 1;
    unit->state = *state;
    return 0;
}

static int forget(Unit *unit, void **place, char *message) {
    message[0] = 0;
    if (place && *place) {
        give(unit, *place);
        *place = 0;
    }
    return 0;
}

static int measure(size_t *size, char *message) {
    if (!size) {
        snprintf(message, MESSAGE, "the size is a null pointer");
        return 1;
    }
    *size = UNIT_BYTES;
    return 0;
}

static int serialize(const State *state, void *bytes, size_t size, char *message) {
    return missing(state, "no state of this unit", message) || unit_serialize(state, bytes, size, message);
}

static int deserialize(Unit *unit, const void *bytes, size_t size, void **place, char *message) {
    State state;
    if (unit_deserialize(&state, bytes, size, message)) return 1;
    /* The standard does not say that the place is empty. */
    if (place) *place = 0;
    return keep(unit, &state, place, message);
}

/* The versions spell their names differently. */
#define FUNCTIONS_OF_STATES(get, set, release, bytes_of, to_bytes, of_bytes)                                           \
    FMI(Status) get(HANDLE c, void **state) { DO(keep(unit, &unit->state, state, message)); }                          \
    FMI(Status) set(HANDLE c, void *state) { DO(restore(unit, state, message)); }                                      \
    FMI(Status) release(HANDLE c, void **state) { DO(forget(unit, state, message)); }                                  \
    FMI(Status) bytes_of(HANDLE c, void *state, size_t *size) {                                                        \
        (void)state;                                                                                                   \
        DO(measure(size, message));                                                                                    \
    }                                                                                                                  \
    FMI(Status) to_bytes(HANDLE c, void *state, BYTE bytes[], size_t size) {                                           \
        DO(serialize(state, bytes, size, message));                                                                    \
    }                                                                                                                  \
    FMI(Status) of_bytes(HANDLE c, const BYTE bytes[], size_t size, void **state) {                                    \
        DO(deserialize(unit, bytes, size, state, message));                                                            \
    }
