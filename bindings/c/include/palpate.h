#ifndef PALPATE_H
#define PALPATE_H

/* Written by cbindgen from bindings/c/src and src/core; `bindings/c/run` checks that it is current. */

#include <stddef.h>
#include <stdint.h>

// What a call answers: 0, or why it was refused. A refused call writes no result.
enum PalpateError
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The call did what it was asked for.
  PALPATE_ERROR_OK = 0,
  // A pointer is null.
  PALPATE_ERROR_NULL_POINTER,
  // A pointer is not a multiple of its type's alignment.
  PALPATE_ERROR_UNALIGNED,
  // Memory to write to overlaps other memory of the same call.
  PALPATE_ERROR_OVERLAP,
  // There is no sample.
  PALPATE_ERROR_EMPTY,
  // A list has another length than the call needs.
  PALPATE_ERROR_LENGTH,
  // A sample is NaN or infinite.
  PALPATE_ERROR_NOT_FINITE,
  // A number is outside the range in which there is an answer, or is NaN.
  PALPATE_ERROR_OUT_OF_RANGE,
  // The signal is 0, or the nuisances explain it.
  PALPATE_ERROR_NO_SIGNAL,
  // The covariance is not symmetric.
  PALPATE_ERROR_NOT_SYMMETRIC,
  // The covariance is not positive definite to working precision.
  PALPATE_ERROR_NOT_POSITIVE_DEFINITE,
  // The answer is too large for a double.
  PALPATE_ERROR_OVERFLOW,
  // The knots are not 2 to 1024 numbers within 1 m, each at least 1e-6 m above the one before.
  PALPATE_ERROR_KNOTS,
  // A force of the table is not a number within 100 N.
  PALPATE_ERROR_TABLE_FORCE,
  // The structure is not what its `init` made.
  PALPATE_ERROR_NOT_INITIALISED,
  // A limit of the servo loop is out of its range.
  PALPATE_ERROR_LIMITS,
  // The bytes are no report of this kind.
  PALPATE_ERROR_REPORT,
  // The device's units do not allow forces to be computed.
  PALPATE_ERROR_DEVICE,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PalpateError PalpateError;
#else
typedef uint32_t PalpateError;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Feature report 4: what the device is told.
enum PalpateControl
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Play no force until enabled.
  PALPATE_CONTROL_STOP = 0,
  // Play the force reports.
  PALPATE_CONTROL_ENABLE = 1,
  // Clear the device's own fault.
  PALPATE_CONTROL_CLEAR_FAULT = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PalpateControl PalpateControl;
#else
typedef uint8_t PalpateControl;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Lengths in bytes, of a report with its number.
enum PalpateLength
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Of the report descriptor.
  PALPATE_LENGTH_DESCRIPTOR = 136,
  // Of input report 1.
  PALPATE_LENGTH_POSITION_REPORT = 11,
  // Of output report 2.
  PALPATE_LENGTH_FORCE_REPORT = 8,
  // Of feature report 3.
  PALPATE_LENGTH_CAPABILITIES = 17,
  // Of feature report 4.
  PALPATE_LENGTH_CONTROL = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PalpateLength PalpateLength;
#else
typedef uint32_t PalpateLength;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the program that runs the loop asks of the kernel in a cycle.
enum PalpateServoRequest
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Nothing.
  PALPATE_SERVO_REQUEST_NONE,
  // To arm, also after a fault.
  PALPATE_SERVO_REQUEST_ARM,
  // To disarm.
  PALPATE_SERVO_REQUEST_DISARM,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PalpateServoRequest PalpateServoRequest;
#else
typedef uint8_t PalpateServoRequest;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Whether there may be a force.
enum PalpateServoMode
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Not yet.
  PALPATE_SERVO_MODE_DISARMED,
  // Yes, while the deadman is held and samples are fresh.
  PALPATE_SERVO_MODE_ARMED,
  // Not until it is armed again: a position is NaN or infinite.
  PALPATE_SERVO_MODE_FAULT_NOT_FINITE,
  // Not until it is armed again: the device reported a fault.
  PALPATE_SERVO_MODE_FAULT_DEVICE,
  // Not until it is armed again: too many cycles without a fresh sample.
  PALPATE_SERVO_MODE_FAULT_WATCHDOG,
  // Not until it is armed again: the state was overwritten.
  PALPATE_SERVO_MODE_FAULT_STATE,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PalpateServoMode PalpateServoMode;
#else
typedef uint8_t PalpateServoMode;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The costs C_ij of deciding i when H = j, in any one unit.
typedef struct {
  // Deciding 0 when H = 0.
  double c00;
  // Deciding 0 when H = 1: a miss.
  double c01;
  // Deciding 1 when H = 0: a false alarm.
  double c10;
  // Deciding 1 when H = 1.
  double c11;
} PalpateCosts;

// The two probabilities of error at a threshold.
typedef struct {
  // Pr(Ĥ = 1 | H = 0).
  double false_alarm;
  // Pr(Ĥ = 0 | H = 1).
  double miss;
} PalpateErrorRates;

// A noise budget. All standard deviations in N.
typedef struct {
  // The signal-to-noise ratio that the error rates need.
  double gamma;
  // What all the noise together may be, signal/γ.
  double total_allowed_n;
  // What further sources may add, 0 if the given ones exhaust the budget.
  double remaining_n;
} PalpateNoiseBudget;

// Input report 1: where the handle is.
typedef struct {
  // Lateral position, counts.
  int16_t lateral;
  // Position along the normal, counts, positive out of the gel.
  int16_t normal;
  // Switches: bit 0 is the deadman.
  uint8_t buttons;
  // State of the device: bit 0 a fault, bit 1 its watchdog.
  uint8_t status;
  // Number of this report, modulo 65536.
  uint16_t sequence;
  // Number of the last force report that the device played.
  uint16_t force_sequence;
} PalpatePositionReport;

// Output report 2: what to play.
typedef struct {
  // Lateral force, counts.
  int16_t lateral;
  // Normal force, counts, positive out of the gel.
  int16_t normal;
  // Number of this report, modulo 65536.
  uint16_t sequence;
  // Bit 0: play the force; otherwise the device plays none.
  uint8_t flags;
} PalpateForceReport;
// The bit of [`ForceReport::flags`] that lets the device play the force.
#define PalpateForceReport_PLAY 1

// Feature report 3: what the device is.
typedef struct {
  // Version of the profile: 1.
  uint16_t version;
  // Length of a count of a position, nm.
  uint16_t position_unit_nm;
  // Force of a count, µN.
  uint16_t force_unit_un;
  // Largest force of each axis, mN.
  uint16_t largest_force_mn;
  // Time between two position reports, µs.
  uint16_t period_us;
  // Time without a force report after which the device drops the force, ms.
  uint16_t watchdog_ms;
  // Viscous damping of each axis, mN·s/m.
  uint16_t damping_mn_s_per_m;
  // Coulomb friction of each axis, mN.
  uint16_t friction_mn;
} PalpateCapabilities;

// One report of the device, in metres.
typedef struct {
  // Depth of the probe, m.
  float depth_m;
  // Lateral position of the probe, m.
  float lateral_m;
  // Its number, modulo 65536.
  uint16_t sequence;
  // Not 0 while the deadman switch is held.
  uint8_t deadman;
  // Not 0 if the device says that something is wrong with it.
  uint8_t device_fault;
} PalpateServoSample;

// A lateral and a normal force on the probe, or what belongs to each: samples of them, their noise, their energy.
//
// Lateral is along +x, normal is positive where it pushes the probe out of the gel. Where it holds numbers they are newtons.
typedef struct {
  // Along +x.
  float lateral;
  // Out of the gel.
  float normal;
} PalpateForce_f32;

// A force on the probe, N.
typedef PalpateForce_f32 PalpateForce;

// What one cycle tells the device.
typedef struct {
  // The force to play, N.
  PalpateForce force;
  // 1 while the force follows the table; otherwise it is on its way to zero.
  uint8_t playing;
  // 0.
  uint8_t reserved[3];
} PalpateServoCommand;

// Both tails of a law at a point x.
typedef struct {
  // Pr(X < x).
  double lower;
  // Pr(X ≥ x).
  double upper;
} PalpateTails;

// The ends of an interval that holds a number with a stated probability.
typedef struct {
  // Lower end.
  double lower;
  // Upper end.
  double upper;
} PalpateInterval;

// Samples of the force along a trajectory, N: as many lateral as normal ones.
typedef struct {
  // The lateral force, N.
  const double *lateral;
  // The normal force, N.
  const double *normal;
  // The number of samples in each.
  size_t samples;
} PalpateSeries;

// A lateral and a normal force on the probe, or what belongs to each: samples of them, their noise, their energy.
//
// Lateral is along +x, normal is positive where it pushes the probe out of the gel. Where it holds numbers they are newtons.
typedef struct {
  // Along +x.
  double lateral;
  // Out of the gel.
  double normal;
} PalpateForce_f64;

// A lateral and a normal number, such as the standard deviation of the noise of one sample, N.
typedef PalpateForce_f64 PalpateComponents;

// What a template and its noise give, before any record.
typedef struct {
  // b of each channel.
  PalpateComponents b;
  // σ of each channel's output.
  PalpateComponents sigma;
  // γ, the signal-to-noise ratio of both channels.
  double gamma;
} PalpateFilter;

// What the filter says about one record.
typedef struct {
  // Y(0) of equation (5), N. A channel whose template is zero has 0.
  PalpateForce_f64 y;
  // θ of equation (7), the log-likelihood ratio.
  double theta;
  // γ, the signal-to-noise ratio of the hypotheses.
  double gamma;
} PalpateStatistic;

// What a record in coloured noise says.
typedef struct {
  // θ, the log-likelihood ratio.
  double theta;
  // γ = (ΔᵀK⁻¹Δ)^½.
  double gamma;
} PalpateThetaGamma;

// ln of the densities of a record in coloured noise, without their factor (2π)^(−n/2), alone and with a signal whose amplitude is
// normal with mean 1.
typedef struct {
  // Without the signal.
  double without;
  // With it.
  double with;
  // The square of the Mahalanobis distance of the record, without the signal.
  double distance_without;
  // The same with it.
  double distance_with;
} PalpateColouredEvidence;

// What a whitened record says beside nuisances.
typedef struct {
  // T, over the estimate of the noise where its level is unknown.
  double t;
  // γ in the same unit.
  double gamma;
  // γ if every nuisance were known.
  double gamma_nominal;
  // Σ of the squares that neither the nuisances nor the template explain.
  double residual;
  // θ, the log-likelihood ratio.
  double theta;
  // At most these rates of error at the threshold for `eta`.
  PalpateErrorRates rates;
  // The number of independent nuisances.
  size_t rank;
  // Degrees of freedom of `residual`.
  size_t degrees;
} PalpateSubspaceStatistic;

// The largest Θ of a scan.
typedef struct {
  // Θ_max.
  double theta;
  // γ at the shift of the maximum.
  double gamma;
  // The shift of the maximum, the first of several equal ones.
  ptrdiff_t shift;
  // The vertex of the parabola through the maximum and its two neighbours, in samples: the shift
  // without the grid. It is the shift itself at the ends of the scan.
  double refined_shift;
} PalpateScanMaximum;

// A structure of the library in the caller's memory.
typedef struct {
  // Says what the words hold.
  size_t tag;
  // The structure.
  size_t words[16];
} PalpateKept;

// What `palpate_sequential_init` makes of the caller's memory, to which it keeps a pointer. Its content is the library's.
typedef struct {
  PalpateKept kept;
} PalpatePreparedSequential;

// What the rows so far say of one hypothesis.
typedef struct {
  // (Pδ)ᵀz.
  double along;
  // γ² = |Pδ|², 0 where the nuisances explain the signal.
  double gamma_squared;
} PalpateEvidence;

// What all hypotheses have in common.
typedef struct {
  // Σ of the squares that the nuisances do not explain.
  double residual;
  // The rows so far, without the missing ones.
  size_t rows;
  // The rows that were missing.
  size_t missing;
  // How many nuisances the rows tell apart.
  size_t rank;
} PalpateSequentialRows;

// What `palpate_table_init` makes of knots and forces, to which it keeps pointers. Its content is the library's.
typedef struct {
  PalpateKept kept;
} PalpatePreparedTable;

// Where a position lies: a cell of an axis, and the fraction of its width.
typedef struct {
  // The cell, from 0 to the number of cells minus 1.
  size_t index;
  // 0 at the cell's first knot, 1 at its last; from −1 to 2 outside the axis.
  float fraction;
} PalpateCell;

// What the commands must keep to, component by component (SRV-022).
typedef struct {
  // Largest magnitude of a force, N; at most 20.
  float force_n;
  // Largest growth in one cycle, N; from 1e-4 to `force_n`.
  float slew_n;
  // Largest fall in one cycle, N; at least `slew_n` and 1/16 of `force_n`.
  float release_n;
  // Longest run of cycles without a fresh sample that is no fault, 1 to 100.
  uint16_t watchdog_cycles;
} PalpateServoLimits;

// What one cycle leaves to the next. All zero is the state to begin with.
typedef struct {
  // The last command, N.
  PalpateForce force;
  // The number of the last sample taken over.
  uint16_t sequence;
  // Cycles since the last fresh sample.
  uint16_t missed;
  // A `PALPATE_SERVO_MODE_…`.
  uint8_t mode;
  // 1 if `sequence` is the number of a sample.
  uint8_t has_sequence;
  // 1 if the last cycle had a request to arm.
  uint8_t arming;
  // 0.
  uint8_t reserved;
} PalpateServoState;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// 1 if θ ≥ η, an inclusion; 0 otherwise. Refuses NaN; a refusal is no answer.
PalpateError palpate_decide(double theta, double eta, uint8_t *inclusion);

// Pr(H = 1 | record) from θ and the prior probability of an inclusion.
PalpateError palpate_posterior(double theta, double prior_h1, double *p);

// η of the most probable hypothesis.
PalpateError palpate_map_threshold(double prior_h1, double *eta);

// η of the least expected cost.
PalpateError palpate_bayes_threshold(double prior_h1, const PalpateCosts *costs, double *eta);

// The largest η with at most this rate of misses.
PalpateError palpate_neyman_pearson_miss_threshold(double gamma, double max_miss, double *eta);

// The least η with at most this rate of false alarms.
PalpateError palpate_neyman_pearson_false_alarm_threshold(double gamma, double max_false_alarm, double *eta);

// The rates of error at a threshold η on θ.
PalpateError palpate_error_rates(double gamma, double eta, PalpateErrorRates *rates);

// The rate of misses on the receiver operating characteristic at a rate of false alarms.
PalpateError palpate_roc_miss(double gamma, double false_alarm, double *miss);

// The least γ for two rates of error.
PalpateError palpate_required_gamma(double max_false_alarm, double max_miss, double *gamma);

// The rate of right answers in a choice of two; also the area under the receiver operating characteristic.
PalpateError palpate_two_afc(double gamma, double *p_correct);

// γ from the rate of right answers in a choice of two.
PalpateError palpate_gamma_from_two_afc(double p_correct, double *gamma);

// The noise that a signal of `signal_n` allows at two rates of error, beside `count` sources (standard deviations, N).
PalpateError palpate_noise_budget(double signal_n,
                                  double max_false_alarm,
                                  double max_miss,
                                  const double *sources_n,
                                  size_t count,
                                  PalpateNoiseBudget *budget);

// What an error means, in one line that ends with a zero. Never null, also for a number that is no error.
const char *palpate_error_text(uint32_t error);

// The report descriptor of the profile, `PALPATE_LENGTH_DESCRIPTOR` bytes that never change.
const uint8_t *palpate_report_descriptor(void);

// The position report in `length` = 11 bytes.
PalpateError palpate_position_report_decode(const uint8_t *start, size_t length, PalpatePositionReport *report);

// The `length` = 11 bytes of a position report.
PalpateError palpate_position_report_encode(const PalpatePositionReport *report, uint8_t *start, size_t length);

// The force report in `length` = 8 bytes.
PalpateError palpate_force_report_decode(const uint8_t *start, size_t length, PalpateForceReport *report);

// The `length` = 8 bytes of a force report.
PalpateError palpate_force_report_encode(const PalpateForceReport *report, uint8_t *start, size_t length);

// The capabilities in `length` = 17 bytes.
PalpateError palpate_capabilities_decode(const uint8_t *start, size_t length, PalpateCapabilities *report);

// The `length` = 17 bytes of capabilities.
PalpateError palpate_capabilities_encode(const PalpateCapabilities *report, uint8_t *start, size_t length);

// The `PALPATE_CONTROL_…` in the `length` = 2 bytes of a control report.
PalpateError palpate_control_decode(const uint8_t *start, size_t length, uint8_t *control);

// The `length` = 2 bytes of the control report for a `PALPATE_CONTROL_…`.
PalpateError palpate_control_encode(uint8_t control, uint8_t *start, size_t length);

// What a position report says, in metres.
PalpateError palpate_sample_of_report(const PalpateCapabilities *device,
                                      const PalpatePositionReport *report,
                                      PalpateServoSample *sample);

// The report with this number that plays a command.
PalpateError palpate_report_of_command(const PalpateCapabilities *device,
                                       const PalpateServoCommand *command,
                                       uint16_t sequence,
                                       PalpateForceReport *report);

// Φ(x), the probability that a standard normal number is at most x. Refuses NaN.
PalpateError palpate_normal_cdf(double x, double *p);

// Φ⁻¹(p) for 0 < p < 1.
PalpateError palpate_normal_quantile(double p, double *x);

// Tails of noncentral chi-square at x, with `degrees` of freedom and noncentrality λ.
PalpateError palpate_chi_square_tail(double x, double degrees, double noncentrality, PalpateTails *tails);

// Tails of noncentral F at x, with two degrees of freedom and noncentrality λ.
PalpateError palpate_f_tail(double x, double numerator, double denominator, double noncentrality, PalpateTails *tails);

// Tails of noncentral Student's t at x, with `degrees` of freedom and noncentrality δ.
PalpateError palpate_student_tail(double x, double degrees, double noncentrality, PalpateTails *tails);

// The exact interval of Clopper and Pearson at 0 < `confidence` < 1. Takes about √trials steps for each of some 120 tails.
PalpateError palpate_clopper_pearson(uint64_t successes,
                                     uint64_t trials,
                                     double confidence,
                                     PalpateInterval *interval);

// Wilson's interval at 0 < `confidence` < 1.
PalpateError palpate_wilson(uint64_t successes, uint64_t trials, double confidence, PalpateInterval *interval);

// b, σ and γ of a template F_1 − F_0 in white noise.
PalpateError palpate_matched_filter(const PalpateSeries *template_,
                                    const PalpateComponents *noise_sd,
                                    PalpateFilter *filter);

// θ, y(0) and γ of a record, from the forces without (`f0`) and with (`f1`) the inclusion, in white noise.
PalpateError palpate_theta(const PalpateSeries *observed,
                           const PalpateSeries *f0,
                           const PalpateSeries *f1,
                           const PalpateComponents *noise_sd,
                           PalpateStatistic *statistic);

// The length of the scratch that `palpate_theta_coloured` and `palpate_evidence_coloured` need: n² + 2n.
size_t palpate_coloured_scratch(size_t n);

// θ and γ in noise of any covariance over both channels. `residual` and `template` have n numbers, the lateral samples and then
// the normal ones; `covariance` has n rows of n (N²). `scratch` has n² + 2n, overlaps nothing, and is overwritten.
PalpateError palpate_theta_coloured(const double *residual,
                                    const double *template_,
                                    const double *covariance,
                                    size_t n,
                                    double *scratch,
                                    size_t scratch_length,
                                    PalpateThetaGamma *found);

// ln of the densities of a record without, and with a signal whose amplitude has a standard deviation of `amplitude_sd` about 1. The
// others are those of `palpate_theta_coloured`; `covariance` holds a class of disturbance, the noise and the signal's uncertain shape.
PalpateError palpate_evidence_coloured(const double *residual,
                                       const double *template_,
                                       const double *covariance,
                                       size_t n,
                                       double amplitude_sd,
                                       double *scratch,
                                       size_t scratch_length,
                                       PalpateColouredEvidence *found);

// T, γ, θ and rates of error of a whitened record of `samples` numbers beside `count` nuisances, one after the other.
//
// Each sample is over the standard deviation of its noise. `residual`, `template` and `nuisances` are overwritten and must not
// overlap. `known_level` is 0 if the record itself tells the level of the noise. `bias` is what a nuisance within bounds may add
// to T, 0 for none; `eta` the threshold on θ.
PalpateError palpate_theta_nuisances(double *residual,
                                     double *template_,
                                     size_t samples,
                                     double *nuisances,
                                     size_t count,
                                     uint8_t known_level,
                                     double bias,
                                     double eta,
                                     PalpateSubspaceStatistic *found);

// Θ at every shift k = 0 … N − M at which the whole template of M samples lies in the record of N, into `theta`, and the
// largest. `theta` has `count` = N − M + 1 numbers and overlaps nothing.
PalpateError palpate_scan(const PalpateSeries *residual,
                          const PalpateSeries *template_,
                          const PalpateComponents *noise_sd,
                          double *theta,
                          size_t count,
                          PalpateScanMaximum *maximum);

// How many numbers a detector of so many hypotheses beside so many nuisances needs.
size_t palpate_sequential_memory(size_t hypotheses, size_t nuisances);

// Makes a detector before its first row. It keeps a pointer to the `length` numbers of `memory`, as many as `palpate_sequential_memory`
// says: they must stay where they are, unchanged by others, as long as it is used. A copy of the detector is no second one.
PalpateError palpate_sequential_init(size_t hypotheses,
                                     size_t nuisances,
                                     double *memory,
                                     size_t length,
                                     PalpatePreparedSequential *detector);

// Adds a row: one sample of one channel over the standard deviation of its noise. `residual` is F_p − F_0, NaN if it is missing;
// `nuisances` what each adds for an amplitude of 1; `signals` F_k − F_0 of each hypothesis.
PalpateError palpate_sequential_push(PalpatePreparedSequential *detector,
                                     double residual,
                                     const double *nuisances,
                                     size_t nuisance_count,
                                     const double *signals,
                                     size_t signal_count);

// What the rows so far say of each hypothesis, into `evidence`, a list of `count` that overlaps nothing. θ is along − gamma_squared/2.
PalpateError palpate_sequential_evidence(const PalpatePreparedSequential *prepared,
                                         PalpateEvidence *evidence,
                                         size_t count);

// Counts the rows so far.
PalpateError palpate_sequential_rows(const PalpatePreparedSequential *prepared, PalpateSequentialRows *rows);

// Wald's test with at most these rates of false alarms and of misses: 1 for an inclusion, −1 for none, 0 while it goes on.
PalpateError palpate_wald(double max_false_alarm,
                          double max_miss,
                          double theta,
                          int8_t *decision);

// Makes a table of depths and lateral positions (m, increasing) and of the force at each pair (N): `depths` rows of `laterals`
// forces. `scratch` has depths + laterals − 2 numbers.
//
// The table keeps pointers to all four lists: they must stay where they are, unchanged, as long as it is used.
PalpateError palpate_table_init(const float *depth_knots_m,
                                size_t depths,
                                const float *lateral_knots_m,
                                size_t laterals,
                                const PalpateForce *forces_n,
                                float *scratch,
                                size_t scratch_length,
                                PalpatePreparedTable *table);

// The force of a table at a depth and lateral position (m): bilinear, continued one cell beyond the border, zero above the
// surface. Total for every bit pattern of the position.
PalpateError palpate_table_force(const PalpatePreparedTable *prepared,
                                 float depth_m,
                                 float lateral_m,
                                 PalpateForce *force);

// Cell and fraction of a position on an axis of `count` knots (m). `scratch` has count − 1 numbers. To compare with another
// kernel: it checks the axis anew in each call.
PalpateError palpate_axis_locate(const float *knots_m,
                                 size_t count,
                                 float *scratch,
                                 size_t scratch_length,
                                 float position_m,
                                 PalpateCell *cell);

// One cycle of the servo loop: from `state`, the newest sample (null if none came) and a `PALPATE_SERVO_REQUEST_…` to the next state and the
// command. A refused call commands no force, from which the force of the next call grows, unless `command` is null or overlaps something;
// it leaves the rest of the state, and all of a state that overlaps something.
//
// Total and bounded for every bit pattern of state and sample: a mode that does not exist counts as memory overwritten, a request
// that does not exist disarms.
PalpateError palpate_step(const PalpatePreparedTable *prepared,
                          const PalpateServoLimits *limits,
                          const PalpateServoSample *sample,
                          uint8_t request,
                          PalpateServoState *state,
                          PalpateServoCommand *command);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PALPATE_H */
