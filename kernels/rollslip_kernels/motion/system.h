/* An initial value problem of arrow shape, y' = f(t, y), as C sees it; capsule "rollslip.system.v1".
 *
 * - y = [head (H) | roller 0 (B) | ... | roller Z-1 (B) | ledger (L) | shares of roller 0 (S) | ...]: nothing but the
 *   head and its own block influences a roller and its shares, and ledger and shares influence nothing.  So the Jacobian
 *   is an arrow, found by differences in H + B evaluations of all rollers at once, whatever Z is, and solved with in
 *   work proportional to Z.
 * - Ours alone, unlike rollslip.h: both sides of it are always built together.
 * - The context of the capsule is a reference to the owner, which keeps `state` and `scale` alive and answers
 *   refusal() after a status k > 0. */
#ifndef ROLLSLIP_SYSTEM
#define ROLLSLIP_SYSTEM "rollslip.system.v1"
#include <stddef.h>

/* The derivatives that are not zero by the shape, each row by row (C order). */
typedef struct {
    double *head_head;      /* [(H+L) x H]      head and ledger rates by head, what the rollers add included */
    double *head_roller;    /* [Z x (H+L+S) x B]  what a roller adds and its shares, by its own unknowns */
    double *roller_head;    /* [Z x B x H] */
    double *roller_roller;  /* [Z x B x B] */
    double *record_head;   /* [Z x S x H] */
} rs_arrow;

/* Every function returns 0; -1: a Python error is set; k > 0: refused, the owner's refusal() says what. All
   arguments are finite; all results are written. Called without the GIL. */
typedef struct {
    size_t head;      /* H unknowns before the rollers; n = H + rollers*(block + shares) + ledger */
    size_t rollers;   /* Z */
    size_t block;     /* B unknowns of a roller */
    size_t ledger;    /* L recorded values behind the rollers */
    /* rates of the rollers' unknowns [Z x B], and what each adds to the rates of head and ledger and those of its
       shares [Z x (H+L+S)]; NULL, and never called, without rollers */
    int (*roller_rates)(double t, const double *head, const double *rollers, double *rates, double *added,
                        void *state);
    /* the head's and ledger's own rates [H+L], to which those are added */
    int (*head_rates)(double t, const double *head, double *rates, void *state);
    /* values whose change of sign is an event [watched]; NULL if none */
    size_t watched;
    int (*watch)(double t, const double *y, double *values, void *state);
    /* the derivatives; NULL: by differences */
    int (*jacobian)(double t, const double *y, const rs_arrow *arrow, void *state);
    const double *scale;   /* [n] typical magnitudes > 0 of the unknowns, for differences */
    int autonomous;        /* 1: no time in the rates */
    void *state;
    void *speeds_state;    /* of functions that read speeds alone: until_contact, drift, flight, clear */
    /* Fast motions, which steps have to resolve; members are appended here and never moved.
       Angular frequencies [rad/s]: of contacts that close and open, while one is closed; the fastest of permanent
       oscillations. 0: there is none, or it is not known. */
    double contact_frequency;
    double swing_frequency;
    /* time [s] after which a contact closes at the present speeds, 0 while one is closed, INFINITY if none will;
       NULL with a contact_frequency of 0 */
    double (*until_contact)(double t, const double *y, void *speeds_state);
    /* places: unknowns whose rates are sums of speeds with constant factors, and nothing else. [n] 0 for a place, 1
       for any other; NULL: not known. drift adds h times the rates of the places to them, nothing else moves. */
    const double *kicked;
    int (*drift)(double h, double *y, void *speeds_state);
    /* all rates at once [n], the same to rounding; NULL: the parts above are summed */
    int (*rates)(double t, const double *y, double *rates, void *state);
    /* What changes slowly, friction above all, may be linearised in time and speeds about the state where it was
       evaluated last; NULL: nothing is.
       renew evaluates and linearises it at (t, y); `report` gets the fastest rate [1/s] at which it damps the speeds
       of a roller, and, where compared is not 0, the relative error of the linearisation until then.
       linearised_rates gives all rates by it; with half > 0, of a step of 2 half whose rates of kicked unknowns were
       `before`, with friction as it is at the speeds in the middle of the step that it brings about. */
    int (*renew)(double t, const double *y, int compared, double *report, void *state);
    int (*linearised_rates)(double t, const double *y, double half, const double *before, double *rates, void *state);
    /* while not 0, rates and their parts leave friction as it was linearised: what is damped without it */
    int *still;
    /* time in which no contact closes if the rates stay as they are, at most `max_time`; NULL: not known */
    double (*flight)(double t, const double *y, const double *rates, double max_time, void *speeds_state);
    /* Contacts that close and open, apart from all other forces, so that substeps resolve their oscillations;
       NULL: not separated.
       While *separate_contacts is not 0, linearised_rates leaves contacts out. go drifts by h from t on, and in
       parts of h adds to speeds and ledger what contacts do, with the damping at the speeds in the middle. clear:
       whether no contact closes within a time h from where linearised_rates was called last, at the speeds there. */
    int *separate_contacts;
    int (*go)(double t, double h, size_t parts, double *y, void *state);
    int (*clear)(double h, void *speeds_state);
    /* values recorded of each roller, as the ledger is of all; 0 of systems that record none */
    size_t shares;
} rs_system;
#endif
