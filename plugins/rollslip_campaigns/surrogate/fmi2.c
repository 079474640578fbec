/* The bearing as a co-simulation unit of FMI 2.0.
 *
 * - Layout and names are fixed by the text of the standard; what is used of its types stands here, its headers need not
 *   be shipped.
 * - Outputs are those at the end of a step, inputs are held during it.  A state is a copy of numbers, since what belongs
 *   to the instance, its name and its callbacks, is not part of it.
 * - Inputs beyond the tables are held at their ends. The logger gets a warning when one goes there, whether or not the
 *   host asks for debug logging, and with debug logging a message when all are back. */
#include <math.h>
#include <stddef.h>
#include <string.h>
#include "bearing.h"
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#ifdef FMI2_HEADERS   /* held against those of the standard */
#include "fmi2Functions.h"
#undef EXPORT
#define EXPORT FMI2_Export
typedef fmi2Component Component;
typedef fmi2ComponentEnvironment Environment;
typedef fmi2FMUstate State;
typedef fmi2String String;
typedef fmi2ValueReference Ref;
typedef fmi2Boolean Boolean;
typedef fmi2Integer Integer;
typedef fmi2Real Real;
typedef fmi2Byte Byte;
typedef fmi2Status Status;
typedef fmi2StatusKind StatusKind;
typedef fmi2Type Type;
typedef fmi2CallbackFunctions Callbacks;
#define OK fmi2OK
#define WARNING fmi2Warning
#define DISCARD fmi2Discard
#define ERROR fmi2Error
#define call_allocate(c) (c)->allocateMemory
#define call_release(c) (c)->freeMemory
#define call_environment(c) (c)->componentEnvironment
#define COSIMULATION fmi2CoSimulation
#else
typedef void *Component, *Environment, *State;
typedef const char *String;
typedef unsigned int Ref;
typedef int Boolean, Integer;
typedef double Real;
typedef char Byte;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef enum { DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED } StatusKind;
typedef enum { MODEL_EXCHANGE, COSIMULATION } Type;
typedef struct {
    void (*logger)(Environment, String, Status, String, String, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(Environment, Status);
    Environment environment;
} Callbacks;
#define call_allocate(c) (c)->allocate
#define call_release(c) (c)->release
#define call_environment(c) (c)->environment
#endif
#define GUIDS 64
typedef struct { const Callbacks *call; char name[128]; int logs, starting, outside; bearing *b; } Unit;
typedef struct { char guid[GUIDS]; int starting, outside; } Head;   /* of a state; the numbers of the bearing follow */
static size_t state_size(void) { return sizeof(Head) + bearing_size(); }
static void log_message(const Unit *unit, Status status, String category, String text) {
    if (unit->call->logger && (unit->logs || status >= WARNING))
        unit->call->logger(call_environment(unit->call), unit->name, status, category, "%s", text);
}
static Status log_error(const Unit *unit, String why) { log_message(unit, ERROR, "logStatusError", why); return ERROR; }
static void report_outside(Unit *unit) {
    int now = bearing_outside(unit->b);
    if (now != unit->outside) log_message(unit, now ? WARNING : OK, "logStatusWarning", bearing_message(now));
    unit->outside = now;
}
EXPORT String fmi2GetTypesPlatform(void) { return "default"; }
EXPORT String fmi2GetVersion(void) { return "2.0"; }
EXPORT Component fmi2Instantiate(String name, Type type, String guid, String place, const Callbacks *call, Boolean seen, Boolean logging) {
    Unit *unit;
    (void)place, (void)seen;
    if (!call || !call_allocate(call) || !call_release(call) || !(unit = call_allocate(call)(1, sizeof *unit))) return NULL;
    unit->call = call, unit->logs = logging;
    if (name) strncpy(unit->name, name, sizeof unit->name - 1);
    if (type != COSIMULATION) log_error(unit, "this unit is for co-simulation");
    else if (!guid || strcmp(guid, bearing_guid())) log_error(unit, "the GUID is not that of this unit");
    else if ((unit->b = call_allocate(call)(1, bearing_size()))) { bearing_init(unit->b); return unit; }
    call_release(call)(unit);
    return NULL;
}
EXPORT void fmi2FreeInstance(Component c) {
    Unit *unit = c;
    if (!unit) return;
    call_release(unit->call)(unit->b), call_release(unit->call)(unit);
}
EXPORT Status fmi2SetDebugLogging(Component c, Boolean on, size_t n, const String s[]) {
    (void)n, (void)s;
    ((Unit *)c)->logs = on;
    return OK;
}
EXPORT Status fmi2SetupExperiment(Component c, Boolean toleranced, Real tolerance, Real start, Boolean ends, Real stop) {
    (void)toleranced, (void)tolerance, (void)ends, (void)stop;
    bearing_values(((Unit *)c)->b)[B_TIME] = start;
    return OK;
}
EXPORT Status fmi2EnterInitializationMode(Component c) { ((Unit *)c)->starting = 1; return OK; }
EXPORT Status fmi2ExitInitializationMode(Component c) {
    Unit *unit = c;
    report_outside(unit), bearing_start(unit->b), unit->starting = 0;
    return OK;
}
EXPORT Status fmi2Terminate(Component c) { (void)c; return OK; }
EXPORT Status fmi2Reset(Component c) {
    Unit *unit = c;
    bearing_init(unit->b), unit->starting = unit->outside = 0;
    return OK;
}
EXPORT Status fmi2GetReal(Component c, const Ref r[], size_t n, Real v[]) {
    Unit *unit = c;
    if (unit->starting) bearing_start(unit->b);
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= B_VALUES) return log_error(unit, "no such variable");
        v[i] = bearing_values(unit->b)[r[i]];
    }
    return OK;
}
EXPORT Status fmi2SetReal(Component c, const Ref r[], size_t n, const Real v[]) {
    Unit *unit = c;
    for (size_t i = 0; i < n; i++) {
        if (!(r[i] >= B_RADIAL_LOAD && r[i] <= B_TEMPERATURE) && r[i] != B_FIRST_CAGE_SLIP)
            return log_error(unit, "this variable cannot be set");
        if (!isfinite(v[i])) return log_error(unit, "an input is no finite number");
    }
    for (size_t i = 0; i < n; i++) bearing_values(unit->b)[r[i]] = v[i];
    return OK;
}
#define NONE(kind, type) \
    EXPORT Status fmi2Get##kind(Component c, const Ref r[], size_t n, type v[]) { \
        (void)r, (void)v; \
        return n ? log_error(c, "all variables are real") : OK; \
    } \
    EXPORT Status fmi2Set##kind(Component c, const Ref r[], size_t n, const type v[]) { \
        (void)r, (void)v; \
        return n ? log_error(c, "all variables are real") : OK; \
    }
NONE(Integer, Integer) NONE(Boolean, Boolean) NONE(String, String)
static void put(const Unit *unit, char *to) {
    Head head = {.starting = unit->starting, .outside = unit->outside};
    strncpy(head.guid, bearing_guid(), GUIDS - 1);
    memcpy(to, &head, sizeof head), memcpy(to + sizeof head, unit->b, bearing_size());
}
static Status take(Unit *unit, const char *from) {
    Head head;
    memcpy(&head, from, sizeof head);
    if (strncmp(head.guid, bearing_guid(), GUIDS)) return log_error(unit, "this is a state of another unit");
    unit->starting = head.starting, unit->outside = head.outside, memcpy(unit->b, from + sizeof head, bearing_size());
    return OK;
}
EXPORT Status fmi2GetFMUstate(Component c, State *s) {
    Unit *unit = c;
    if (!*s && !(*s = call_allocate(unit->call)(1, state_size()))) return ERROR;
    put(unit, *s);
    return OK;
}
EXPORT Status fmi2SetFMUstate(Component c, State s) { return take(c, s); }
EXPORT Status fmi2FreeFMUstate(Component c, State *s) {
    if (*s) call_release(((Unit *)c)->call)(*s);
    *s = NULL;
    return OK;
}
EXPORT Status fmi2SerializedFMUstateSize(Component c, State s, size_t *n) { (void)c, (void)s; *n = state_size(); return OK; }
EXPORT Status fmi2SerializeFMUstate(Component c, State s, Byte to[], size_t n) {
    if (n < state_size()) return log_error(c, "there is too little room for the state");
    memcpy(to, s, state_size());
    return OK;
}
EXPORT Status fmi2DeSerializeFMUstate(Component c, const Byte from[], size_t n, State *s) {
    Unit *unit = c;
    if (n != state_size()) return log_error(unit, "this is no state of this unit");
    if (!*s && !(*s = call_allocate(unit->call)(1, n))) return ERROR;
    memcpy(*s, from, n);
    return OK;
}
EXPORT Status fmi2GetDirectionalDerivative(Component c, const Ref z[], size_t nz, const Ref v[], size_t nv, const Real dv[], Real dz[]) {
    (void)z, (void)nz, (void)v, (void)nv, (void)dv, (void)dz;
    return log_error(c, "this unit has no directional derivatives");
}
EXPORT Status fmi2SetRealInputDerivatives(Component c, const Ref r[], size_t n, const Integer o[], const Real v[]) {
    (void)r, (void)n, (void)o, (void)v;
    return log_error(c, "inputs are held during a step");
}
EXPORT Status fmi2GetRealOutputDerivatives(Component c, const Ref r[], size_t n, const Integer o[], Real v[]) {
    (void)r, (void)n, (void)o, (void)v;
    return log_error(c, "this unit has no derivatives of its outputs");
}
EXPORT Status fmi2DoStep(Component c, Real at, Real span, Boolean no_way_back) {
    Unit *unit = c;
    (void)no_way_back;
    report_outside(unit);
    if (span > 0.0 && !bearing_step(unit->b, span)) return log_error(unit, "no step of time is short enough");
    bearing_values(unit->b)[B_TIME] = at + span, bearing_output(unit->b);
    return OK;
}
EXPORT Status fmi2CancelStep(Component c) { (void)c; return ERROR; }
#define STATUS(kind, type) \
    EXPORT Status fmi2Get##kind(Component c, const StatusKind what, type *v) { (void)c, (void)what, (void)v; return DISCARD; }
STATUS(Status, Status) STATUS(RealStatus, Real) STATUS(IntegerStatus, Integer) STATUS(BooleanStatus, Boolean)
STATUS(StringStatus, String)
